// Free bodies of fix floe/create under the stock integration of fix multisphere, against closed solutions.
// The figures it prints are those of stock LIGGGHTS' Richardson iteration for quaternions.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "free_rotation.hpp"
#include "solids.hpp"

namespace embacle::liggghts {
namespace {

using coupling::Mat3;
using coupling::Quaternion;
using coupling::Vec3;

constexpr double mass = 7.2;                // of the box 0.4 x 0.2 x 0.1 m
constexpr double middle = 5, third = 0.05;  // [rad/s]: about the middle axis, and a little across
const Vec3 moments = mass / 12 * Vec3(0.2 * 0.2 + 0.1 * 0.1, 0.4 * 0.4 + 0.1 * 0.1, 0.4 * 0.4 + 0.2 * 0.2);

double angle_between(const Mat3& a, const Mat3& b) {
  return 2 * std::asin(std::min(1.0, (a - b).norm() / std::sqrt(8.0)));
}

struct Drift {
  double energy = 0, momentum = 0;              // largest, relative
  double energy_end = 0;                        // at the end, with its sign
  double orientation = 0, orientation_end = 0;  // [rad]
};

Drift tumble(double step, int steps) {
  Solids solids;
  solids.prepare();
  solids.run({fmt::format("fix floes all floe/create shape box 0.4 0.2 0.1 mass {} spacing 0.1 position 0 0 0 "
                          "omega 0 {} {}",
                          mass, middle, third),
              fmt::format("timestep {:.17g}", step), "run 0"});
  const FreeRotation exact(moments, middle, third);
  Vec3 momentum_before = Vec3::Zero();
  double energy_before = 0;
  Drift drift;
  constexpr int samples = 50;
  for (int sample = 0; sample <= samples; ++sample) {
    if (sample > 0) solids.run({fmt::format("run {} pre no post no", steps / samples)});
    const auto bodies = solids.bodies();
    if (bodies.empty()) return drift;
    const auto& state = bodies[0].state;
    const Mat3 turn = state.orientation.toRotationMatrix();
    const Vec3 momentum = turn * moments.asDiagonal() * turn.transpose() * state.angular_velocity;
    const double energy = 0.5 * momentum.dot(state.angular_velocity);
    if (sample == 0) {
      momentum_before = momentum;
      energy_before = energy;
    }
    const double time = step * steps * sample / samples;
    drift.energy_end = energy / energy_before - 1;
    drift.energy = std::max(drift.energy, std::abs(drift.energy_end));
    drift.momentum = std::max(drift.momentum, (momentum - momentum_before).norm() / momentum_before.norm());
    drift.orientation_end = angle_between(turn, exact.orientation(time));
    drift.orientation = std::max(drift.orientation, drift.orientation_end);
  }
  return drift;
}

TEST(FreeRotation, ReferenceObeysEuler) {
  const FreeRotation exact(moments, middle, third);
  EXPECT_LT((exact.angular_velocity(0) - Vec3(0, middle, third)).norm(), 1e-12);
  EXPECT_LT((exact.orientation(0) - Mat3::Identity()).norm(), 1e-12);
  const Vec3 momentum = moments.cwiseProduct(exact.angular_velocity(0));
  double largest = 0;
  for (double time = 0.1; time < 10; time += 0.37) {
    const double h = 1e-4;
    const Vec3 w = exact.angular_velocity(time);
    const Vec3 rate = (exact.angular_velocity(time + h) - exact.angular_velocity(time - h)) / (2 * h);
    EXPECT_LT((moments.cwiseProduct(rate) + w.cross(moments.cwiseProduct(w))).norm(), 1e-6) << time;
    const Mat3 turn = exact.orientation(time);
    EXPECT_LT((turn * moments.cwiseProduct(w) - momentum).norm(), 1e-11) << time;
    const Mat3 spin = turn.transpose() * (exact.orientation(time + h) - exact.orientation(time - h)) / (2 * h);
    EXPECT_LT((Vec3(spin(2, 1), spin(0, 2), spin(1, 0)) - w).norm(), 1e-5) << time;
    EXPECT_LT(angle_between(turn, exact.orientation(time, 4000)), 2e-9) << time;
    largest = std::max(largest, std::abs(w[0]));
  }
  EXPECT_GT(largest, 4);  // it does tumble
}

TEST(FreeMotion, TumblesAboutTheMiddleAxisAsJacobi) {
  const double time = 10;
  std::vector<Drift> drifts;
  for (const int steps : {25000, 50000, 100000}) {
    drifts.push_back(tumble(time / steps, steps));
    const Drift& d = drifts.back();
    fmt::print(
        "{:6d} steps of {:.0e} s ({:.1e} rad): energy drift {:.2e} (end {:+.2e}), angular momentum {:.2e}, "
        "orientation {:.2e} rad (end {:.2e})",
        steps, time / steps, middle * time / steps, d.energy, d.energy_end, d.momentum, d.orientation,
        d.orientation_end);
    if (drifts.size() > 1) {
      const double order = std::log2(drifts[drifts.size() - 2].orientation / d.orientation);
      fmt::print(", order {:.2f}", order);
      EXPECT_GT(order, 2.9);
    }
    fmt::print("\n");
    EXPECT_LT(d.energy, 1e-6);
    EXPECT_LT(d.momentum, 1e-12);
  }
  EXPECT_LT(drifts.back().orientation, 1e-5);
}

TEST(FreeMotion, FallIsExact) {
  Solids solids;
  solids.prepare();
  const Vec3 start(0.1, -0.2, 0.6), velocity(0.3, 0.1, 0.5);
  solids.run({"fix gravity all gravity 9.81 vector 0 0 -1",
              "fix floes all floe/create shape box 0.4 0.2 0.1 density 900 spacing 0.1 position 0.1 -0.2 0.6 "
              "rotate 1 2 3 40 velocity 0.3 0.1 0.5 omega 1 2 -3",
              "timestep 1e-5", "run 40000"});
  const double time = 0.4;
  const auto bodies = solids.bodies();
  ASSERT_EQ(bodies.size(), 1U);
  const Vec3 gravity(0, 0, -9.81);
  const double way = (bodies[0].state.position - (start + time * velocity + 0.5 * time * time * gravity)).norm();
  const double speed = (bodies[0].state.velocity - (velocity + time * gravity)).norm();
  fmt::print("free fall over 40000 steps: error {:.1e} m of 0.58 m, {:.1e} m/s of 3.4 m/s\n", way, speed);
  EXPECT_LT(way, 1e-10);
  EXPECT_LT(speed, 1e-10);
}

}  // namespace
}  // namespace embacle::liggghts
