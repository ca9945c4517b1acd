// What keeps water out of walls.
#include <gtest/gtest.h>

#include <cmath>

#include "core/diagnostics.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::run;

/// One particle above (or, if negative, in) the bottom of a tank, without gravity; the sound speed is 10 m/s.
Scene lone_particle(double height, double speed) {
  Scene scene = test::still_tank(2, 10);
  scene.fluid.gravity = {};
  scene.numerics.reference_speed = 1;
  Water& water = scene.water.front();
  water.kind = Water::Kind::table;
  water.table.has_velocity = true;
  water.table.rows.push_back({{0.05, height, 0}, {0, speed, 0}});
  return scene;
}

const Record& lone(const Simulation& simulation) { return simulation.particles().record[0]; }

TEST(Guard, WaterInAWallLeavesAtABoundedSpeed) {
  for (const double depth : {0.1, 0.5, 0.9}) {  // in spacings
    const Scene scene = lone_particle(-depth * 0.01, 0);
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    double fastest = 0;
    int steps = 0;
    ASSERT_NEAR(lone(simulation).x[1], -depth * 0.01, 1e-15);
    for (; lone(simulation).x[1] < 0 && steps < 100; ++steps) {
      run(simulation, 1);
      fastest = std::max(fastest, std::abs(lone(simulation).v[1]));
    }
    EXPECT_LT(steps, 60) << depth;
    EXPECT_LE(fastest, 0.05 * 10 * (1 + 1e-12)) << depth;
    EXPECT_GT(fastest, 0.04 * 10) << depth;
  }
}

TEST(Guard, FastWaterStopsAtAWall) {
  const Scene scene = lone_particle(0.0031, -5);
  Simulation simulation(scene, MPI_COMM_SELF, nullptr);
  for (int step = 0; step < 50; ++step) {
    run(simulation, 1);
    EXPECT_GT(lone(simulation).x[1], 0) << step;
  }
  EXPECT_LE(std::abs(lone(simulation).v[1]), 0.05 * 10 * (1 + 1e-12));
}

/// Lowest and highest total energy over what the lone particle does, in terms of that of the start.
std::pair<double, double> range_of_energy(Scene scene, int steps) {
  scene.output.audit = true;
  Simulation simulation(scene, MPI_COMM_SELF, nullptr);
  run(simulation, 1);
  const double start = measure(simulation, scene).energy.total();
  double lowest = 1, highest = 1;
  for (int step = 0; step < steps; ++step) {
    run(simulation, 1);
    const double now = measure(simulation, scene).energy.total() / start;
    lowest = std::min(lowest, now);
    highest = std::max(highest, now);
  }
  return {lowest, highest};
}

TEST(Energy, ABounceOnAWallKeepsIt) {
  // Compressed by several percent, so that an integral over s^2 would be short by 3 %.
  Scene scene = lone_particle(0.04, -1);
  Simulation simulation(scene, MPI_COMM_SELF, nullptr);
  run(simulation, 150);
  EXPECT_GT(lone(simulation).v[1], 0.99);
  const auto [lowest, highest] = range_of_energy(scene, 150);
  EXPECT_GT(lowest, 0.995);
  EXPECT_LT(highest, 1.005);
}

TEST(Energy, WhatTheGuardsSpringGivesBackWasThere) {
  // At rest within its reach: all energy is the spring's.
  const Scene scene = lone_particle(0.001, 0);
  Simulation simulation(scene, MPI_COMM_SELF, nullptr);
  run(simulation, 200);
  EXPECT_GT(lone(simulation).x[1], 0.0012);
  EXPECT_LT(range_of_energy(scene, 200).second, 1.01);
}

}  // namespace
}  // namespace embacle::mps
