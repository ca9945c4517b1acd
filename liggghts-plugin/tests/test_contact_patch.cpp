// Patches press as the gradient of a potential, and as elementary cases ask; the damping number is the right one.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "contact/floe_law.hpp"
#include "contact/near_pairs.hpp"
#include "contact/stored_energy.hpp"

namespace embacle::liggghts {
namespace {

using coupling::Mat3;
using coupling::Vec3;

ConvexShape box(double x, double y, double z) {
  coupling::Shape shape;
  shape.kind = coupling::ShapeKind::box;
  shape.size = Vec3(x, y, z);
  return convex_shape(shape, "test");
}

coupling::Load load_of(const Patch& patch) {
  coupling::Load load;
  for (const auto& place : patch.places) {
    load.force += place.force;
    load.torque += place.position.cross(place.force);
  }
  return load;
}

TEST(ContactPatch, FacesOfABoxDivideItsVolume) {
  const ConvexShape shape = box(0.4, 0.3, 0.1);
  ASSERT_EQ(shape.faces.size(), 6U);
  EXPECT_EQ(shape.corners.size(), 8U);
  EXPECT_NEAR(shape.thickness, 0.1, 1e-15);
  EXPECT_NEAR(shape.reach, Vec3(0.2, 0.15, 0.05).norm(), 1e-15);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  for (int n = 0; n < 1000; ++n) {
    const Vec3 x(0.4 * share(random), 0.3 * share(random), 0.1 * share(random));
    int inside = 0;
    for (const auto& face : shape.faces) {
      bool holds = true;
      for (const auto& bound : face.region) holds = holds && bound.normal.dot(x) <= bound.offset;
      inside += holds ? 1 : 0;
    }
    EXPECT_EQ(inside, 1);
  }
}

TEST(ContactPatch, FaceOnFaceIsTwoSpringsInARow) {
  const ConvexShape lower = box(0.4, 0.3, 0.1), upper = box(0.1, 0.1, 0.1);
  const PosedShape a{&upper, Mat3::Identity(), Vec3(0, 0, 0.0995), 3e8}, b{&lower, Mat3::Identity(), Vec3::Zero(), 1e8};
  Patch patch;
  press(a, b, -separation(a, b), patch);
  const auto load = load_of(patch);
  const double spring = 3e8 * 1e8 / 4e8 * 0.01;
  EXPECT_NEAR(load.force.z(), spring * 0.0005, 1e-2 * spring * 0.0005);  // its rim yields sideways
  EXPECT_NEAR(load.force.head<2>().norm(), 0, 1e-9 * load.force.z());
  EXPECT_NEAR(patch.stiffness, spring, 0.05 * spring);
  Patch on_plane;
  press_plane(a, Vec3(0, 0, 0.05), Vec3::UnitZ(), on_plane);
  EXPECT_NEAR(load_of(on_plane).force.z(), 3e8 * 0.0005 * 0.01, 0.03 * 3e8 * 0.0005 * 0.01);
}

TEST(ContactPatch, FlushFacesAreCountedOnce) {
  // Four sides of each box lie in the planes of the other's; the potential still gives the force: with the depth d, the
  // area A and its edge P, h (A d / 2 - P (d / 2)^2 / 2) but for the corners.
  const ConvexShape shape = box(0.2, 0.2, 0.1);
  const double depth = 1e-5, hardness = 5e8;
  const PosedShape a{&shape, Mat3::Identity(), Vec3::Zero(), hardness};
  const PosedShape b{&shape, Mat3::Identity(), Vec3(0.2 - depth, 0, 0), hardness};
  Patch patch;
  press(a, b, -separation(a, b), patch);
  const double expected = hardness * (0.02 * depth / 2 - 0.6 * depth * depth / 8);
  EXPECT_NEAR(load_of(patch).force.x(), -expected, 1e-5 * expected);
}

/// Mean square of the pressure's distance from its centre [m^2].
double mean_square_of(const Patch& patch) {
  Vec3 centre = Vec3::Zero();
  double weight = 0;
  for (const auto& place : patch.places) {
    centre += place.size * place.position;
    weight += place.size;
  }
  return patch.spread / weight - (centre / weight).squaredNorm();
}

TEST(ContactPatch, SpreadIsThatOfThePressureHoweverThePatchFallsIntoTriangles) {
  const ConvexShape shape = box(0.2, 0.2, 0.1), slab = box(1, 1, 0.4);
  Patch patch;
  // Flat on a plane: a square under even pressure, but for its rim.
  press_plane({&shape, Mat3::Identity(), Vec3::Zero(), 5e8}, Vec3(0, 0, 1e-6 - 0.05), Vec3::UnitZ(), patch);
  EXPECT_NEAR(mean_square_of(patch), 0.2 * 0.2 / 6, 1e-4 * 0.2 * 0.2 / 6);
  // On an edge upon a slab: nearly a line, and the same in whatever direction it lies, from either body's frame.
  const PosedShape below{&slab, Mat3::Identity(), Vec3::Zero(), 5e8};
  const double expected = 0.2 * 0.2 / 12, tilt = 0.3, depth = 1e-4;
  for (int k = 0; k < 40; ++k) {
    const Mat3 axes = (Eigen::AngleAxisd(0.17 * k, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitX())).matrix();
    const Vec3 place(0, 0, 0.2 + 0.1 * std::sin(tilt) + 0.05 * std::cos(tilt) - depth);
    const PosedShape above{&shape, axes, place, 5e8};
    for (const auto& [first, second] : {std::pair(below, above), std::pair(above, below)}) {
      patch.clear();
      press(first, second, -separation(first, second), patch);
      EXPECT_NEAR(mean_square_of(patch), expected, 5e-3 * expected) << k;
    }
  }
}

/// Work [J] along a closed path of one body around another, relative to the sum of its sizes.
double relative_circulation(const ConvexShape& moving, const ConvexShape& fixed, int steps) {
  double work = 0, traffic = 0;
  coupling::Load before;
  Vec3 position_before = Vec3::Zero(), turn_before = Vec3::Zero();
  for (int n = 0; n <= steps; ++n) {
    const double t = 2 * std::numbers::pi * n / steps;
    // Through face, edge and corner contacts: sideways, in and out, and turning about a fixed axis.
    const Vec3 position(0.12 + 0.05 * std::sin(t), 0.09 + 0.03 * std::cos(2 * t), 0.145 + 0.02 * std::cos(t));
    const Vec3 axis = Vec3(1, 2, -0.5).normalized();
    const double angle = 0.7 + 0.3 * std::sin(t + 0.4);
    const PosedShape a{&moving, Eigen::AngleAxisd(angle, axis).toRotationMatrix(), position, 2e8};
    const PosedShape b{&fixed, Mat3::Identity(), Vec3::Zero(), 1e8};
    Patch patch;
    press(a, b, -separation(a, b), patch);
    coupling::Load load = load_of(patch);
    load.torque -= position.cross(load.force);  // about the moving body's centre
    if (n > 0) {
      const double step = 0.5 * (load.force + before.force).dot(position - position_before) +
                          0.5 * (load.torque + before.torque).dot(angle * axis - turn_before);
      work += step;
      traffic += std::abs(step);
    }
    before = load;
    position_before = position;
    turn_before = angle * axis;
  }
  EXPECT_GT(traffic, 0);
  return std::abs(work) / traffic;
}

TEST(ContactPatch, ForcesHaveAPotential) {
  const ConvexShape big = box(0.4, 0.3, 0.1), cube = box(0.2, 0.2, 0.2);
  const double coarse = relative_circulation(cube, big, 500), fine = relative_circulation(cube, big, 2000);
  EXPECT_LT(fine, 1e-5);
  EXPECT_LT(fine, 0.2 * coarse);  // the trapezium rule's error, of second order
}

TEST(ContactPatch, ForceIsTheSlopeOfTheStoredEnergy) {
  const ConvexShape big = box(0.4, 0.3, 0.1), cube = box(0.2, 0.2, 0.2);
  // Flush faces: the whole overlap once. Depths of 0.25 and 0.75 mm, pressure 75 kPa: p^2 / 2 (1 / h1 + 1 / h2) A.
  const PosedShape lower{&big, Mat3::Identity(), Vec3::Zero(), 1e8};
  const PosedShape same{&big, Mat3::Identity(), Vec3(0, 0, 0.099), 3e8};
  EXPECT_NEAR(stored_energy(lower, same), 0.5 * 0.75e5 * 1e-3 * 0.12, 5e-3 * 4.5);  // less near the rim
  const PosedShape equal{&big, Mat3::Identity(), Vec3(0, 0, 0.099), 1e8};
  EXPECT_NEAR(stored_energy(lower, equal), 0.5 * 0.5e5 * 1e-3 * 0.12, 5e-3 * 3);
  EXPECT_EQ(stored_energy(lower, {&big, Mat3::Identity(), Vec3(0, 0, 0.101), 1e8}), 0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  int touching = 0;
  for (int n = 0; n < 200; ++n) {
    const Mat3 turn =
        coupling::Quaternion(any(random), any(random), any(random), any(random)).normalized().toRotationMatrix();
    const Vec3 place(0.15 * any(random), 0.15 * any(random), 0.13 + 0.03 * any(random));
    const auto at = [&](const Vec3& x) { return PosedShape{&cube, turn, x, 3e8}; };
    Patch patch, on_plane;
    const double overlap = -separation(at(place), lower);
    if (overlap <= 0) continue;
    press(at(place), lower, overlap, patch);
    if (patch.empty()) continue;
    ++touching;
    const Vec3 point(0, 0, 0.05);
    press_plane(at(place), point, Vec3::UnitZ(), on_plane);
    const Vec3 force = load_of(patch).force;
    constexpr double way = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const auto slope = [&](const auto& energy) {
        return (energy(Vec3(place - way * Vec3::Unit(k))) - energy(Vec3(place + way * Vec3::Unit(k)))) / (2 * way);
      };
      EXPECT_NEAR(slope([&](const Vec3& x) { return stored_energy(at(x), lower); }), force[k], 1e-4 * force.norm());
      EXPECT_NEAR(slope([&](const Vec3& x) { return stored_energy(lower, at(x)); }), force[k], 1e-4 * force.norm());
      EXPECT_NEAR(slope([&](const Vec3& x) { return stored_energy_at_plane(at(x), point, Vec3::UnitZ()); }),
                  load_of(on_plane).force[k], 1e-4 * force.norm());
    }
  }
  EXPECT_GT(touching, 50);
}

TEST(ContactPatch, SeparationIsALowerBound) {
  const ConvexShape shape = box(0.2, 0.2, 0.1);
  const PosedShape a{&shape, Mat3::Identity(), Vec3::Zero(), 1}, b{&shape, Mat3::Identity(), Vec3(0, 0, 0.13), 1};
  EXPECT_NEAR(separation(a, b), 0.03, 1e-15);
  EXPECT_NEAR(separation_from_plane(b, Vec3(0, 0, 0.02), Vec3::UnitZ()), 0.06, 1e-15);
  const coupling::Triangle far = {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0)};
  EXPECT_NEAR(separation_from_triangle(a, far), 4.9, 1e-12);
}

TEST(ContactLaw, DampingNumberGivesTheRestitution) {
  for (const double restitution : {0.05, 0.1, 0.5, 0.9, 0.99}) {
    const double number = damping_number(restitution);
    // m dv/dt = -d (1 + x v), d' = v, unit mass and stiffness, v = 1 at first.
    double v = 1, d = 0;
    const double dt = 1e-5;
    while (d >= 0) {
      v -= dt * d * (1 + number * v);
      d += dt * v;
    }
    EXPECT_NEAR(-v, restitution, 1e-3);
  }
  EXPECT_EQ(damping_number(1), 0);
  EXPECT_GT(damping_number(0), 10);
}

TEST(NearPairs, AreThoseOfAllPairs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1), size(0.02, 0.15);
  for (const double period : {0.0, 2.0, 0.9}) {
    std::vector<Vec3> centres;
    std::vector<double> radii;
    for (int n = 0; n < 200; ++n) {
      centres.emplace_back(place(random), place(random), place(random));
      radii.push_back(size(random));
    }
    const Vec3 box(period, 0, period);
    const auto found = near_pairs(centres, radii, 150, 0.05, box);
    std::vector<std::pair<int, int>> expected;
    for (int i = 0; i < 150; ++i) {
      for (int j = i + 1; j < 200; ++j) {
        Vec3 apart = centres[j] - centres[i];
        for (int k = 0; k < 3; ++k) {
          if (box[k] > 0) apart[k] -= box[k] * std::round(apart[k] / box[k]);
        }
        if (apart.norm() < radii[i] + radii[j] + 0.05) expected.emplace_back(i, j);
      }
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace embacle::liggghts
