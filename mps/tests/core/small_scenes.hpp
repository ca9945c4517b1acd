// Small scenes for the tests of the core.
#pragma once

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

}  // namespace embacle::mps::test
