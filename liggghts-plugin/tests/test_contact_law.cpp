// The contact laws against first principles: units, limits, restitution, duration, and no energy from nothing.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "laws/contact_law.hpp"

namespace embacle::liggghts::laws {
namespace {

using Law = std::function<Coefficients(const Pair&, double)>;

/// Sphere of the drop case on its floor: 0.1 m, 1200 kg/m3, 70 MPa.
Pair soft_sphere(double damping) {
  const double modulus = 1 / ((1 - 0.01) / 7e7 + (1 - 0.09) / 2.1e11);
  return {.modulus = modulus, .length = 0.05, .mass = 1200 * M_PI / 6 * 1e-3, .damping = damping};
}

struct Collision {
  double restitution = 0, duration = 0, deepest = 0, largest_force = 0;
};

/// One collision without gravity, by Verlet's method with `steps` steps in the undamped duration.
Collision collide(const Law& law, const Pair& pair, double speed, double steps = 20000) {
  const double step = contact_duration(pair, speed) / steps;
  double overlap = 0, rate = speed, force = 0;
  Collision result;
  for (;;) {
    rate -= 0.5 * step * force / pair.mass;
    overlap += step * rate;
    if (overlap <= 0) break;
    const Coefficients c = law(pair, overlap);
    force = c.normal_stiffness * overlap + c.normal_damping * rate;
    rate -= 0.5 * step * force / pair.mass;
    result.duration += step;
    result.deepest = std::max(result.deepest, overlap);
    result.largest_force = std::max(result.largest_force, force);
  }
  result.restitution = -rate / speed;
  return result;
}

const std::array<Law, 2> laws = {contact_ratio_law, river_ice_law};

TEST(ContactLaw, HasTheUnitsOfStiffnessAndDamping) {
  // The same contact measured in other units of mass, length and time.
  const double mass = 3, length = 0.2, time = 7;
  const Pair pair = soft_sphere(0.14);
  Pair other = pair;
  other.modulus *= mass / (length * time * time);
  other.length *= length;
  other.mass *= mass;
  const double stiffness = mass / (time * time), damping = mass / time;
  for (const Law& law : laws) {
    const Coefficients a = law(pair, 1e-3), b = law(other, 1e-3 * length);
    EXPECT_NEAR(b.normal_stiffness / (stiffness * a.normal_stiffness), 1, 1e-14);
    EXPECT_NEAR(b.normal_damping / (damping * a.normal_damping), 1, 1e-14);
    EXPECT_NEAR(b.tangential_stiffness / (stiffness * a.tangential_stiffness), 1, 1e-14);
    EXPECT_NEAR(b.tangential_damping / (damping * a.tangential_damping), 1, 1e-14);
  }
}

TEST(ContactLaw, UndampedIsHertz) {
  // Speed, deepest overlap, largest force and duration of Hertz' closed form for this sphere and floor.
  const double expected[][4] = {{1, 0.0010679097, 735.45371, 0.0031431039}, {4, 0.0032372969, 3881.748, 0.0023820273}};
  for (const auto& [speed, overlap, force, duration] : expected) {
    EXPECT_NEAR(contact_duration(soft_sphere(0), speed) / duration, 1, 2e-5);  // digits of the reference
    for (const Law& law : laws) {
      const Collision collision = collide(law, soft_sphere(0), speed);
      EXPECT_NEAR(collision.restitution, 1, 1e-6);
      EXPECT_NEAR(collision.deepest / overlap, 1, 1e-6);
      EXPECT_NEAR(collision.largest_force / force, 1, 1e-6);
      EXPECT_NEAR(collision.duration / duration, 1, 2e-4);
    }
  }
}

TEST(ContactLaw, RestitutionDependsOnTheRatioAlone) {
  for (const double ratio : {0.02, 0.05, 0.14, 0.3, 0.6}) {
    for (const double speed : {0.05, 0.5, 5.0}) {
      for (const double modulus : {1e6, 2.1e11}) {
        Pair pair = soft_sphere(ratio);
        pair.modulus = modulus;
        for (const Law& law : laws)
          EXPECT_NEAR(collide(law, pair, speed).restitution, restitution_of(ratio), 1e-3) << ratio << ' ' << speed;
      }
    }
  }
}

TEST(ContactLaw, RatioAndRestitutionAreInverse) {
  EXPECT_DOUBLE_EQ(restitution_of(0), 1);
  EXPECT_DOUBLE_EQ(restitution_of(largest_ratio()), 0);
  EXPECT_DOUBLE_EQ(ratio_of(1), 0);
  for (const double e : {0.05, 0.5, 0.656, 0.95}) EXPECT_NEAR(restitution_of(ratio_of(e)), e, 1e-14);
  EXPECT_NEAR(restitution_of(0.14), 0.656, 5e-4);
}

TEST(ContactLaw, LengthsOfEqualSpheres) {
  EXPECT_DOUBLE_EQ(effective_radius(0.05, 0.05), 0.025);
  EXPECT_DOUBLE_EQ(effective_spacing(0.05, 0.05), 0.05);  // l0/2 with l0 the diameter
  EXPECT_NEAR(effective_radius(0.05, 1e9), 0.05, 1e-10);
}

class Tangential : public testing::Test {
 protected:
  static constexpr double step = 1e-6;
  const Vec3 normal = Vec3::UnitZ();
  Spring spring;
  Vec3 force(const Coefficients& c, const Vec3& slip, double limit, double slip_velocity = 1e-3) {
    return tangential_force(spring, c, normal, slip, limit, slip_velocity, step, true);
  }
};

TEST_F(Tangential, SpringSumsTheSlipWhateverTheStep) {
  const Coefficients c = {.tangential_stiffness = 1e4, .tangential_damping = 3};
  const Vec3 slip(0.1, 0, 0);
  for (const double dt : {1e-5, 1e-6}) {
    spring = {};
    Vec3 f = Vec3::Zero();
    const int steps = static_cast<int>(std::lround(1e-3 / dt));
    for (int s = 0; s < steps; ++s) f = tangential_force(spring, c, normal, slip, 1e6, 1e-3, dt, true);
    EXPECT_NEAR(f.x(), -(1e4 * 1e-4 + 3 * 0.1), 1e-9);
    EXPECT_EQ(f.y(), 0);
  }
}

TEST_F(Tangential, NeverExceedsFriction) {
  const Coefficients c = {.tangential_stiffness = 1e9, .tangential_damping = 1e5};
  const Vec3 slip(0.03, -0.04, 0);
  Vec3 f;
  for (int s = 0; s < 100; ++s) f = force(c, slip, 10);
  EXPECT_LT((f + 10 * slip.normalized()).norm(), 1e-12);
  EXPECT_LE(c.tangential_stiffness * spring.stretch.norm(), 10 * (1 + 1e-12));
  f = force(c, slip, 10, 0.05);
  EXPECT_NEAR(f.norm(), 10 * std::tanh(1.0), 1e-12);
}

TEST_F(Tangential, NoHistoryYieldsEnergy) {
  struct Phase {
    double velocity;   // along x [m/s]
    double way;        // [m]
    double stiffness;  // [N/m]
    double damping;    // [N s/m]
  };
  const double limit = 10, slip_velocity = 0.125;
  // Work that the slips put in, over each history: it may come back, but no more than it.
  const std::vector<std::vector<Phase>> histories = {
      {{0.1, 1e-4, 1e4, 0}, {-0.1, 1e-4, 1e4, 0}},  // elastic: comes back
      {{0.1, 1e-3, 1e4, 0}, {-0.1, 2e-3, 1e4, 0}},  // sliding to and fro
      {{1e-3, 5e-3, 1e4, 0}, {-1, 2e-3, 1e4, 0}},   // creeps, then is released at once
      {{1, 2e-6, 1e4, 100}, {-1, 1e-3, 1e4, 0}},    // the dashpot slides before the spring is stretched
      {{0.1, 1e-4, 1e4, 0}, {0.1, 1e-12, 4e4, 0}, {-0.1, 1e-3, 4e4, 0}},  // pressed together while stretched
      {{0.1, 1e-4, 4e4, 0}, {0.1, 1e-12, 1e4, 0}, {-0.1, 1e-3, 1e4, 0}}};
  for (std::size_t h = 0; h < histories.size(); ++h) {
    spring = {};
    double work = 0, smallest = 0;
    for (const Phase& phase : histories[h]) {
      const Coefficients c = {.tangential_stiffness = phase.stiffness, .tangential_damping = phase.damping};
      const double dt = phase.way / std::abs(phase.velocity) / 1000;
      Vec3 before = tangential_force(spring, c, normal, Vec3::Zero(), 1e9, slip_velocity, dt, false);
      for (int s = 0; s < 1000; ++s) {
        const Vec3 slip(phase.velocity, 0, 0);
        const Vec3 after = tangential_force(spring, c, normal, slip, limit, slip_velocity, dt, true);
        work -= dt * slip.dot(0.5 * (before + after));
        before = after;
        smallest = std::min(smallest, work);
      }
    }
    EXPECT_GE(smallest, -1e-6) << "history " << h;  // [J]; the spring holds up to 5e-3
  }
}

TEST_F(Tangential, WithoutAdvanceNothingIsKept) {
  const Coefficients c = {.tangential_stiffness = 1e4, .tangential_damping = 0};
  EXPECT_EQ(tangential_force(spring, c, normal, Vec3(1, 0, 0), 1, 1e-3, step, false), Vec3::Zero());
  EXPECT_EQ(spring.stretch, Vec3::Zero());
  EXPECT_EQ(spring.stiffness, 0);
}

TEST_F(Tangential, KeepsTheForceWhereStiffnessGrows) {
  Coefficients c = {.tangential_stiffness = 1e4, .tangential_damping = 0};
  const Vec3 before = force(c, Vec3(0.1, 0, 0), 10);
  c.tangential_stiffness *= 4;
  const Vec3 after = force(c, Vec3(1e-12, 0, 0), 10, 1e-15);
  EXPECT_NEAR(after.x(), before.x(), 1e-9);
  c.tangential_stiffness /= 2;  // shrinks: the stretch is kept
  EXPECT_NEAR(force(c, Vec3(1e-12, 0, 0), 10, 1e-15).x(), before.x() / 2, 1e-9);
}

}  // namespace
}  // namespace embacle::liggghts::laws
