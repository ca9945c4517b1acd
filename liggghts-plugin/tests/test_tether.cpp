// fix floe/tether: pendulums, ropes that are slack, rods that push, damping; on one rank and more.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "solids.hpp"

namespace embacle::liggghts {
namespace {

using coupling::SolidBody;
using coupling::Vec3;

constexpr double gravity = 9.81;
const std::string fall = "fix g all gravity 9.81 vector 0 0 -1";
const std::string cube = "fix floes all floe/create shape box 0.06 0.05 0.04 mass 0.1 spheres 8 ";

/// Angle below the horizontal of a pendulum that starts at rest at 0, by Runge's and Kutta's method.
double swing(double length, double time) {
  const auto rate = [length](double angle) { return gravity / length * std::cos(angle); };
  const int steps = 20000;
  const double h = time / steps;
  double angle = 0, speed = 0;
  for (int n = 0; n < steps; ++n) {
    const double a1 = rate(angle), a2 = rate(angle + 0.5 * h * speed);
    const double a3 = rate(angle + 0.5 * h * (speed + 0.5 * h * a1)), a4 = rate(angle + h * (speed + 0.5 * h * a2));
    angle += h * speed + h * h / 6 * (a1 + a2 + a3);
    speed += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return angle;
}

/// Whether this run has one rank; tests of physics need no more.
bool alone() {
  int ranks = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return ranks == 1;
}

double tension(const Solids& solids) {
  auto* fix = solids.lammps()->modify->find_fix_id("line");
  return fix->compute_scalar();
}

TEST(Tether, SwingsAsAPendulum) {
  if (!alone()) GTEST_SKIP();
  for (const char* kind : {"rope", "rod"}) {
    for (const double time : {0.3, 0.6, 1.2}) {  // through the lowest place at 0.42 s and back
      Solids solids;
      solids.prepare();
      solids.run({fall, cube + "position 0.5 0 0.4",
                  fmt::format("fix line all floe/tether body 1 to 0 0 0.4 {} 0.5 stiffness 1e6", kind),
                  fmt::format("run {}", std::lround(time / 1e-5))});
      const auto state = solids.bodies()[0].state;
      const double angle = swing(0.5, time);
      // It stretches by three weights, 3e-6 m; so does the time of a swing.
      EXPECT_NEAR(state.position.x(), 0.5 * std::cos(angle), 3e-5) << kind << " " << time;
      EXPECT_NEAR(state.position.z(), 0.4 - 0.5 * std::sin(angle), 3e-5) << kind << " " << time;
      EXPECT_NEAR(state.velocity.norm(), std::sqrt(2 * gravity * 0.5 * std::sin(angle)), 3e-4);
      EXPECT_NEAR(tension(solids), 0.1 * 3 * gravity * std::sin(angle), 0.02 * 0.1 * 3 * gravity);
      EXPECT_LT(state.angular_velocity.norm(), 1e-9);  // held at its centre
    }
  }
}

TEST(Tether, TumblingBodyKeepsEnergy) {
  if (!alone()) GTEST_SKIP();
  Solids solids;
  solids.prepare();
  const Vec3 place(0.03, 0.025, 0.02), anchor(0, 0, 0.4);
  solids.run({fall, cube + "position 0.3 0.1 0.4 rotate 1 2 3 40 omega 3 -5 2",
              "fix line all floe/tether body 1 at 0.03 0.025 0.02 to 0 0 0.4 rope 0.38 stiffness 1e5", "run 0"});
  const auto energy = [&] {
    const auto state = solids.bodies()[0].state;
    const Vec3 moments = 0.1 / 12 * Vec3(0.0025 + 0.0016, 0.0036 + 0.0016, 0.0036 + 0.0025);
    const Vec3 turning = state.orientation.conjugate() * state.angular_velocity;
    const double longer = std::max(0.0, (anchor - state.position - state.orientation * place).norm() - 0.38);
    return 0.05 * state.velocity.squaredNorm() + 0.5 * moments.dot(turning.cwiseAbs2()) +
           0.1 * gravity * state.position.z() + 0.5e5 * longer * longer;
  };
  const double before = energy();
  for (int part = 0; part < 10; ++part) {
    solids.run({"run 10000 pre no post no"});
    EXPECT_NEAR(energy(), before, 1e-3 * 0.1 * gravity * 0.3) << part;
  }
}

TEST(Tether, RopesOnlyPullAndRodsAlsoPush) {
  if (!alone()) GTEST_SKIP();
  for (const char* kind : {"rope", "rod"}) {
    Solids solids;
    solids.prepare();
    solids.run({cube + "position 0.5 0 0 velocity -0.1 0 0",
                fmt::format("fix line all floe/tether body 1 to 0 0 0 {} 0.5 stiffness 1e3", kind), "run 10000"});
    const auto state = solids.bodies()[0].state;
    const double frequency = std::sqrt(1e3 / 0.1), time = 0.1;
    const bool rod = std::string(kind) == "rod";
    EXPECT_NEAR(state.position.x(), rod ? 0.5 - 0.1 / frequency * std::sin(frequency * time) : 0.49, 1e-7);
    if (!rod) {
      EXPECT_EQ(tension(solids), 0);
    }
  }
}

TEST(Tether, DampsAsAsked) {
  if (!alone()) GTEST_SKIP();
  Solids solids;
  solids.prepare();
  // 0.1 kg on 1000 N/m: 100 rad/s; 2 N s/m are a tenth of the critical damping.
  solids.run({cube + "position 0.51 0 0", "fix line all floe/tether body 1 to 0 0 0 rod 0.5 stiffness 1e3 damping 2",
              "run 20000"});
  const double decay = 10, frequency = std::sqrt(1e4 - 100.0), time = 0.2;
  const double expected =
      0.01 * std::exp(-decay * time) * (std::cos(frequency * time) + decay / frequency * std::sin(frequency * time));
  EXPECT_NEAR(solids.bodies()[0].state.position.x() - 0.5, expected, 1e-5);
}

/// Two bodies on lines that swing through the middle of the box, where the ranks' parts meet.
struct Swings : Solids {
  explicit Swings(MPI_Comm world, const std::string& restart_file = "") : Solids(world) {
    prepare("5e7", "hertz tangential history", 0.5, 0.4, restart_file);
    run({"timestep 5e-5", fall, cube + "position 0.5 0 0.4 position 0.3 0.2 0 rotate 1 1 0 30",
         "fix line all floe/tether body 1 to 0 0 0.4 rod 0.5 stiffness 1e5",
         "fix other all floe/tether body 2 at 0.03 0 0 to 0 0.2 0.2 rope 0.3 stiffness 1e4", "run 0"});
  }
  void steps(int count) { run({fmt::format("run {} pre no post no", count)}); }
};

void expect_same(const std::vector<SolidBody>& bodies, const std::vector<SolidBody>& expected, double tolerance) {
  ASSERT_EQ(bodies.size(), expected.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_LE((bodies[b].state.position - expected[b].state.position).norm(), tolerance) << b;
    EXPECT_LE((bodies[b].state.velocity - expected[b].state.velocity).norm(), 100 * tolerance) << b;
  }
}

TEST(Tether, RanksAgree) {
  Swings one(MPI_COMM_SELF), all(MPI_COMM_WORLD);
  one.steps(12000);
  all.steps(12000);
  EXPECT_LT(one.bodies()[0].state.position.x(), -0.1);  // it went to the other side
  expect_same(all.bodies(), one.bodies(), 1e-9);
}

TEST(Tether, ContinuesFromARestartFile) {
  Swings whole(MPI_COMM_WORLD);
  whole.steps(9000);
  whole.run({"write_restart tether.restart"});
  whole.steps(1000);
  Swings continued(MPI_COMM_WORLD, "tether.restart");
  continued.steps(1000);
  expect_same(continued.bodies(), whole.bodies(), 0);
}

/// The message of the error of the type that the lines must raise.
template <typename Error>
std::string failure_of(const std::vector<std::string>& lines) {
  auto* solids = new Solids;  // never destroyed: LIGGGHTS cannot clean up after an error
  solids->prepare();
  try {
    solids->run({cube + "position 0.3 0 0"});
    solids->run(lines);
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

TEST(Tether, RefusesWhatCannotBe) {
  if (!alone()) GTEST_SKIP();
  const auto refused = [](const std::string& words, const std::string& part, const std::string& then = "run 0") {
    const std::string message = failure_of<coupling::InputError>({"fix line all floe/tether " + words, then});
    EXPECT_NE(message.find("fix line floe/tether: "), std::string::npos) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  refused("to 0 0 0 rope 0.3 stiffness 1e3", "needs 'body TAG'");
  refused("body 1 rope 0.3 stiffness 1e3", "needs 'to X Y Z'");
  refused("body 1 to 0 0 0 stiffness 1e3", "needs 'rope LENGTH' or 'rod LENGTH'");
  refused("body 1 to 0 0 0 rope 0.3", "needs 'stiffness K'");
  refused("body 1 to 0 0 0 rope 0.3 rod 0.3 stiffness 1e3", "more than one");
  refused("body 1 to 0 0 0 rope 0 stiffness 1e3", "must be greater than zero");
  refused("body 1 to 0 0 0 rope 0.3 stiffness 1e3 damping -1", "must not be negative");
  refused("body 1 to 0 0 0 rop 0.3 stiffness 1e3", "did you mean 'rope'?");
  refused("body 0 to 0 0 0 rope 0.3 stiffness 1e3", "at least 1");
  refused("body 7 to 0 0 0 rope 0.3 stiffness 1e3", "there is no body 7; the largest tag is 1");
  EXPECT_NE(failure_of<coupling::InstabilityError>(
                {"fix line all floe/tether body 1 to 0 0 0 rope 0.2 stiffness 1e12", "run 1"})
                .find("the time step of 1e-05 s is too long"),
            std::string::npos);
}

}  // namespace
}  // namespace embacle::liggghts
