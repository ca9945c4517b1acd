// Periodic directions: images act like any other water, wherever the border lies and however many ranks there are.
#include <gtest/gtest.h>

#include <cmath>

#include "core/decomposition.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::endless_water;
using test::Result;
using test::result_of;
using test::run;
using test::vortices;

/// A column that collapses on a floor, in a domain that is periodic in the other directions; `begin` [m]: where it
/// begins along x.
Scene endless_collapse(int dimension, double begin) {
  const int n = dimension == 3 ? 10 : 20;
  Scene scene = test::collapsing_column(dimension, n);
  const double length = 2 * n * 0.01;
  Wall& tank = scene.walls.front();
  tank.open = {"x-", "x+", dimension == 3 ? "z+" : "y+"};
  scene.periodic = {"x"};
  if (dimension == 3) {
    tank.open.insert(tank.open.end(), {"y-", "y+"});
    scene.periodic.emplace_back("y");
  }
  scene.domain.lower = {0, dimension == 3 ? 0.0 : -1.0, dimension == 3 ? -1.0 : 0.0};
  scene.domain.upper = {length, dimension == 3 ? n * 0.01 : 1.0, dimension == 3 ? 1.0 : 0.0};
  Water& first = scene.water.front();
  first.region.lower[0] = begin;
  first.region.upper[0] = begin + 0.5 * length;
  if (first.region.upper[0] > length) {  // over the border: in two parts
    Water rest = first;
    rest.region.lower[0] = 0;
    rest.region.upper[0] = first.region.upper[0] - length;
    first.region.upper[0] = length;
    scene.water.push_back(rest);
  }
  return scene;
}

void expect_same(const Result& a, const Result& b, double tolerance) {
  EXPECT_EQ(a.state.particles, b.state.particles);
  EXPECT_GT(b.state.energy.kinetic, 0);
  EXPECT_NEAR(a.state.energy.kinetic, b.state.energy.kinetic, tolerance * b.state.energy.kinetic);
  EXPECT_NEAR(a.state.energy.elastic, b.state.energy.elastic, tolerance * b.state.energy.kinetic);
  EXPECT_NEAR(a.state.energy.potential, b.state.energy.potential, tolerance * std::abs(b.state.energy.potential));
  const double momentum = std::sqrt(2 * b.state.mass * b.state.energy.kinetic);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.state.momentum[c], b.state.momentum[c], tolerance * momentum);
}

TEST(Periodic, WrapsAndFindsTheNearestImage) {
  Periodic periodic;
  periodic.lower = {-1, 0, 0};
  periodic.length = {3, 0, 0};
  for (const auto& [place, wrapped] : {std::pair{0.5, 0.5}, {2.0, -1.0}, {-1.25, 1.75}, {11.5, -0.5}, {-1.0, -1.0}}) {
    double x[3] = {place, 7, -7};
    periodic.wrap(x);
    EXPECT_NEAR(x[0], wrapped, 1e-14);
    EXPECT_EQ(x[1], 7);
    EXPECT_EQ(x[2], -7);
  }
  double below[3] = {std::nextafter(-1.0, -2.0), 0, 0};
  periodic.wrap(below);
  EXPECT_GE(below[0], -1);
  EXPECT_LT(below[0], 2);
  EXPECT_NEAR(periodic.nearest(0, 2.5), -0.5, 1e-15);
  EXPECT_EQ(periodic.nearest(1, 2.5), 2.5);
}

TEST(Periodic, ImagesAreNearOneAnotherMutually) {
  Periodic periodic;
  periodic.length = {1, 1, 0};
  Decomposition decomposition(MPI_COMM_WORLD, periodic);
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  std::vector<double> positions;
  for (int k = 0; k < 100; ++k) positions.insert(positions.end(), {std::fmod(k * 0.37, 1.0), (rank + 0.5) / size, 0.0});
  decomposition.partition(2, positions, std::vector<float>(100, 1.0F));
  for (int c = 0; c < 2; ++c) {
    EXPECT_GE(decomposition.own().lower[c], 0);
    EXPECT_LE(decomposition.own().upper[c], 1);
  }
  // Every link is known to both ends: as many from b to a by -image as from a to b by image.
  std::vector<int> links(static_cast<std::size_t>(size) * size * 9, 0);
  for (const Nearby& other : decomposition.nearby(0.05)) {
    ++links[(static_cast<std::size_t>(rank) * size + other.rank) * 9 + other.image[0] + 3 * other.image[1] + 4];
  }
  MPI_Allreduce(MPI_IN_PLACE, links.data(), static_cast<int>(links.size()), MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  int count = 0;
  for (int a = 0; a < size; ++a) {
    for (int b = 0; b < size; ++b) {
      for (int image = -4; image <= 4; ++image) {
        const int there = links[(static_cast<std::size_t>(a) * size + b) * 9 + image + 4];
        EXPECT_EQ(there, links[(static_cast<std::size_t>(b) * size + a) * 9 - image + 4]);
        count += there;
      }
    }
  }
  EXPECT_GE(count, 8);  // one rank alone: itself from all sides
}

TEST(Periodic, AUniformStreamStaysUniform) {
  for (const int dimension : {2, 3}) {
    Scene scene = endless_water(dimension, 12);
    scene.water.front().velocity = {0.7, -0.4, dimension == 3 ? 0.3 : 0.0};
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    run(simulation, dimension == 3 ? 100 : 400);
    if (dimension == 2) {
      EXPECT_GT(simulation.time() * 0.7, 0.12) << "once round";
    }
    const Vec3d& velocity = scene.water.front().velocity;
    for (std::size_t i = 0; i < simulation.particles().water; ++i) {
      const Record& record = simulation.particles().record[i];
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(record.v[c], velocity[c], 1e-11);
      EXPECT_NEAR(record.s, 1, 1e-12);
    }
    const WaterState state = measure(simulation, scene);
    EXPECT_EQ(state.particles, dimension == 3 ? 1728 : 144);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(state.momentum[c], state.mass * velocity[c], 1e-13 * state.mass);
    EXPECT_NEAR(state.interior_share, 1, 1e-12) << "there is no surface";
    EXPECT_NEAR(state.volume_ratio, 1, 1e-9);
  }
}

TEST(Periodic, VorticesConserveMomentumAndAreTheSameOnAnyNumberOfRanks) {
  for (const int dimension : {2, 3}) {
    const int n = dimension == 3 ? 10 : 24;
    const Scene scene = vortices(dimension, n);
    const Result start = result_of(scene, MPI_COMM_WORLD, 1);
    const Result parallel = result_of(scene, MPI_COMM_WORLD, 60);
    const Result alone = result_of(scene, MPI_COMM_SELF, 60);
    expect_same(parallel, alone, 1e-10);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(parallel.state.momentum[c], start.state.momentum[c], 1e-13 * parallel.state.mass);
    // Where the border lies makes no difference.
    expect_same(result_of(vortices(dimension, n, 0.37), MPI_COMM_WORLD, 60), alone, 1e-9);
  }
}

TEST(Periodic, AColumnOnAFloorCollapsesTheSameAnywhere) {
  for (const int dimension : {2, 3}) {
    const int windows = dimension == 3 ? 100 : 200;
    const double length = dimension == 3 ? 0.2 : 0.4;
    const Result alone = result_of(endless_collapse(dimension, 0.25 * length), MPI_COMM_SELF, windows);
    const Result parallel = result_of(endless_collapse(dimension, 0.25 * length), MPI_COMM_WORLD, windows);
    const Result over_border = result_of(endless_collapse(dimension, 0.75 * length), MPI_COMM_WORLD, windows);
    expect_same(parallel, alone, 1e-10);
    expect_same(over_border, alone, 1e-9);
    EXPECT_LT(parallel.audit.momentum_residual, 1e-10);
    EXPECT_GT(parallel.audit.momentum_residual, 0);
    EXPECT_EQ(parallel.state.outside_tank, 0);
  }
}

TEST(Periodic, GaugesAtTheBorderSeeTheImages) {
  Scene scene = test::still_tank(2, 12);
  scene.walls.front().open = {"x-", "x+", "y+"};
  scene.periodic = {"x"};
  scene.domain.lower = {0, -1, 0};
  scene.domain.upper = {0.12, 1, 0};
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 300);
  EXPECT_LT(measure(simulation, scene).energy.kinetic, 1e-4 * 14.4 * 9.81 * 0.12);
  for (const double x : {0.0, 0.055, 0.12}) {
    Gauge gauge;
    gauge.position = {x, 0.03, 0};
    EXPECT_NEAR(pressure_at(simulation, gauge), 1000 * 9.81 * 0.09, 0.02 * 1000 * 9.81 * 0.12);
    EXPECT_NEAR(water_level(simulation, scene, gauge), 0.12, 0.002);
  }
}

TEST(Periodic, GravityAlongAPeriodicDirectionDrives) {
  Scene scene = endless_water(2, 12);
  scene.fluid.gravity = {0.5, 0, 0};
  scene.numerics.reference_speed = 1;
  scene.output.audit = true;
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 200);
  const WaterState state = measure(simulation, scene);
  // The first kick comes after the first move: half a step behind.
  const double driven = simulation.time() - 0.5 * simulation.constants().step;
  EXPECT_NEAR(state.momentum[0], state.mass * 0.5 * driven, 1e-12 * state.mass);
  EXPECT_EQ(state.energy.potential, 0);
  EXPECT_LT(simulation.extremes().pressure, 1e-6);
  EXPECT_LT(simulation.worst_audit().momentum_residual, 1e-12);
}

TEST(Periodic, AWallThatLeavesEntersAgain) {
  // A plate that runs across the border pushes still water on both of its sides alike, wherever it starts.
  const auto driven = [](double begin, MPI_Comm comm) {
    Scene scene = endless_water(2, 24);
    scene.output.audit = true;
    Wall plate;
    plate.name = "plate";
    plate.region = {{begin, 0.06, 0}, {begin + 0.06, 0.12, 0}};
    plate.motion.emplace();
    plate.motion->velocity = {0.5, 0, 0};
    scene.walls = {plate};
    return result_of(scene, comm, 150);
  };
  const Result alone = driven(0.02, MPI_COMM_SELF);
  expect_same(driven(0.02, MPI_COMM_WORLD), alone, 1e-10);
  expect_same(driven(0.16, MPI_COMM_WORLD), alone, 1e-9);
}

}  // namespace
}  // namespace embacle::mps
