// Small scenes for the tests of the core.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "core/periodic.hpp"
#include "scene/scene.hpp"

namespace embacle::mps::test {

/// A tank of still water, n particles wide and deep.
inline Scene still_tank(int dimension, int n, double particle_distance = 0.01) {
  Scene scene;
  scene.title = "still tank";
  scene.file = "still.toml";
  scene.dimension = dimension;
  scene.numerics.particle_distance = particle_distance;
  const double size = n * particle_distance;
  scene.fluid.gravity = {0, 0, 0};
  scene.fluid.gravity[dimension - 1] = -9.81;
  Water water;
  water.name = "water";
  water.region.upper = {size, size, dimension == 3 ? size : 0.0};
  scene.water = {water};
  Wall tank;
  tank.name = "tank";
  tank.kind = Wall::Kind::tank;
  tank.region.upper = water.region.upper;
  tank.region.upper[dimension - 1] *= 1.5;
  tank.open = {dimension == 3 ? "z+" : "y+"};
  scene.walls = {tank};
  scene.domain.lower = {-1, -1, -1};
  scene.domain.upper = {2, 2, 2};
  scene.end_time = 0.1;
  scene.output.fields = false;
  return scene;
}

/// The same water as a column in a tank twice as long: it collapses.
inline Scene collapsing_column(int dimension, int n, double particle_distance = 0.01) {
  Scene scene = still_tank(dimension, n, particle_distance);
  scene.title = "collapsing column";
  scene.walls.front().region.upper[0] *= 2;
  scene.output.audit = true;
  return scene;
}

/// A channel, 40 particles long and 10 deep, through which water flows at 0.4 m/s along x, in 3-D 6 wide: in its first
/// 0.05 m it enters, in its last 0.05 m it leaves.
inline Scene reach(int dimension) {
  Scene scene = still_tank(dimension, 10);
  scene.title = "reach";
  const int up = dimension - 1;
  const Vec3d across = {0, dimension == 3 ? 0.06 : 0.0, 0};
  Water& water = scene.water.front();
  water.region = {{-0.05, 0, 0}, {0.45, across[1], 0}};
  water.region.upper[up] = 0.1;
  water.velocity = {0.4, 0, 0};
  Wall& channel = scene.walls.front();
  channel.region = {{-0.1, 0, 0}, {0.5, across[1], 0}};
  channel.region.upper[up] = 0.2;
  channel.open = {"x-", "x+", dimension == 3 ? "z+" : "y+"};
  Opening inflow;
  inflow.name = "in";
  inflow.region = {{-0.05, 0, 0}, {0, across[1], 0}};
  inflow.region.upper[up] = 0.15;
  inflow.discharge = 0.4 * 0.1 * (dimension == 3 ? 0.06 : scene.thickness);
  Opening outflow = inflow;
  outflow.name = "out";
  outflow.kind = Opening::Kind::outflow;
  outflow.region.lower[0] = 0.4;
  outflow.region.upper[0] = 0.45;
  outflow.discharge.reset();
  outflow.level = 0.1;
  scene.openings = {inflow, outflow};
  scene.numerics.reference_speed = 1.4;
  return scene;
}

/// Water that fills a domain of n particles each way, periodic in all directions, without gravity.
inline Scene endless_water(int dimension, int n, double particle_distance = 0.01) {
  Scene scene = still_tank(dimension, n, particle_distance);
  scene.walls.clear();
  scene.fluid.gravity = {};
  scene.domain = scene.water.front().region;
  scene.periodic = {"x", "y"};
  if (dimension == 3) scene.periodic.emplace_back("z");
  return scene;
}

/// Disordered vortices in it: particles off the lattice by a tenth, all displaced by `shift` periods.
inline Scene vortices(int dimension, int n, double shift = 0) {
  Scene scene = endless_water(dimension, n);
  scene.numerics.reference_speed = 1;
  const double l0 = scene.numerics.particle_distance;
  const double length = n * l0;
  Water& water = scene.water.front();
  water.kind = Water::Kind::table;
  water.table.has_velocity = true;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> off(-0.1 * l0, 0.1 * l0);
  const Periodic periodic = periodic_of(scene);
  for (int k = 0; k < (dimension == 3 ? n : 1); ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        Vec3d x{(i + 0.5) * l0 + off(random), (j + 0.5) * l0 + off(random), 0};
        if (dimension == 3) x[2] = (k + 0.5) * l0 + off(random);
        const double a = 2 * std::numbers::pi / length;
        const Vec3d v{std::sin(a * x[0]) * std::cos(a * x[1]), -std::cos(a * x[0]) * std::sin(a * x[1]), 0};
        for (int c = 0; c < dimension; ++c) x[c] += shift * length;
        periodic.wrap(x.data());
        water.table.rows.push_back({x, v});
      }
    }
  }
  return scene;
}

}  // namespace embacle::mps::test
