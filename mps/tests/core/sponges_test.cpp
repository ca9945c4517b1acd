// Damping of waves: the law, where it acts, and that a wave dies out.
#include <gtest/gtest.h>

#include <cmath>

#include "core/diagnostics.hpp"
#include "core/sponges.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

Sponge beach(double from, double to) {
  Sponge sponge;
  sponge.name = "beach";
  sponge.region = {{from, 0, 0}, {to, 1, 1}};
  return sponge;
}

TEST(Sponges, TheLaw) {
  Scene scene = test::still_tank(2, 10);
  Sponge sponge = beach(2, 3);
  sponge.direction = Direction::x_minus;
  sponge.damping_time = 0.5;
  sponge.velocity = {0.1, 0, 0};
  scene.sponges = {sponge};
  const Constants constants = constants_of(scene);
  std::vector<Traveller> water(4);
  const double places[4] = {1.99, 2.0, 2.5, 2.9};
  for (int i = 0; i < 4; ++i) {
    water[i].record = {};
    water[i].record.x[0] = places[i];
    water[i].record.x[1] = 0.5;
    water[i].record.v[0] = 1.1;
    water[i].record.v[1] = -2;
  }
  Particles particles;
  particles.assign(water);
  Sponges(scene, constants).damp(particles, 0.1);
  const double left[4] = {1, std::exp(-0.2), std::exp(-0.2 * 0.25), std::exp(-0.2 * 0.01)};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(particles.record[i].v[0], 0.1 + left[i], 1e-14) << i;
    EXPECT_NEAR(particles.record[i].v[1], -2 * left[i], 1e-14) << i;
  }
}

TEST(Sponges, DefaultTime) {
  Sponge sponge = beach(1, 3);
  sponge.region.upper[1] = 0.3;
  EXPECT_NEAR(Sponges::damping_time(sponge, 9.81, 1), 2 / (12 * std::sqrt(9.81 * 0.3)), 1e-14);
  sponge.damping_time = 3;
  EXPECT_EQ(Sponges::damping_time(sponge, 9.81, 1), 3);
}

/// A column collapses in a tank twice as long; with a sponge over the tank's other half it comes to rest sooner.
TEST(Sponges, AWaveDiesOut) {
  const auto kinetic = [](bool with) {
    Scene scene = test::collapsing_column(2, 12);
    if (with) scene.sponges = {beach(0.12, 0.24)};
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    test::run(simulation, static_cast<int>(1.5 / simulation.window_length()));
    return measure(simulation, scene).energy.kinetic;
  };
  const double without = kinetic(false), with = kinetic(true);
  EXPECT_LT(with, 0.2 * without);
  EXPECT_GT(without, 0);
}

}  // namespace
}  // namespace embacle::mps
