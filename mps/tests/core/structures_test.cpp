// Forces on walls that ask for them: buoyancy, the weight of the water, the momentum of a jet.
#include <gtest/gtest.h>

#include <cmath>

#include "core/structures.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

/// Means over the last `share` of a run, on rank 0.
std::vector<coupling::Load> mean_loads(const Scene& scene, double seconds, double share) {
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  const int windows = static_cast<int>(seconds / simulation.window_length());
  test::run(simulation, static_cast<int>((1 - share) * windows));
  (void)simulation.structures()->take_means(MPI_COMM_WORLD);
  test::run(simulation, static_cast<int>(share * windows));
  return simulation.structures()->take_means(MPI_COMM_WORLD);
}

bool first_rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank == 0;
}

TEST(Structures, StillWaterGivesBuoyancyAndItsWeight) {
  Scene scene = test::still_tank(2, 40);
  Wall block;
  block.name = "block";
  block.region = {{0.15, 0.12, 0}, {0.25, 0.22, 0}};
  scene.walls.push_back(block);
  for (Wall& wall : scene.walls) wall.forces = true;
  const auto loads = mean_loads(scene, 2.0, 0.5);
  if (!first_rank()) return;
  ASSERT_EQ(loads.size(), 2U);
  const double buoyancy = 1000 * 9.81 * 0.1 * 0.1, weight = 1000 * 9.81 * 0.4 * 0.4 - buoyancy;
  EXPECT_NEAR(loads[1].force[1], buoyancy, 0.02 * buoyancy);
  EXPECT_NEAR(loads[1].force[0], 0, 0.01 * buoyancy);
  EXPECT_NEAR(loads[1].torque[2], 0.2 * buoyancy, 0.03 * 0.2 * buoyancy) << "about the origin";
  EXPECT_NEAR(loads[0].force[1] + loads[1].force[1], -weight, 0.01 * weight);
  EXPECT_EQ(loads[0].force[2], 0);
}

TEST(Structures, OnlyThoseAsked) {
  Scene scene = test::still_tank(2, 10);
  EXPECT_EQ(Simulation(scene, MPI_COMM_WORLD, nullptr).structures(), nullptr);
  scene.walls.front().forces = true;
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  ASSERT_NE(simulation.structures(), nullptr);
  EXPECT_EQ(simulation.structures()->take_means(MPI_COMM_WORLD).size(), 1U) << "no step yet: zero, not a division";
}

}  // namespace
}  // namespace embacle::mps
