// Open boundaries: what enters and leaves is what was asked for, at rest they do nothing, and ranks do not show.
#include <gtest/gtest.h>

#include <cmath>

#include "core/openings.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

double total_mass(const Simulation& simulation, const Scene& scene) { return measure(simulation, scene).mass; }

TEST(Openings, ASteadyReachStaysAsItIs) {
  for (const int dimension : {2, 3}) {
    const Scene scene = test::reach(dimension);
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    test::run(simulation, 1);
    const double mass = total_mass(simulation, scene);
    const int windows = static_cast<int>((dimension == 3 ? 0.5 : 2.0) / simulation.window_length());
    test::run(simulation, windows);
    const auto passed = simulation.openings()->passages();
    const double asked = *scene.openings.front().discharge * simulation.time();
    const double row = passed[0].volume - asked;
    const double column = 0.01 * asked / (0.4 * simulation.time());  // a particle in every row
    EXPECT_LE(std::abs(row), column) << dimension << "-D: the rows have entered up to a particle early or late";
    EXPECT_NEAR(passed[1].volume, asked, 0.05 * asked + column);
    EXPECT_NEAR(passed[0].level, 0.1, 0.003);
    EXPECT_NEAR(passed[1].level, 0.1, 0.003);
    EXPECT_NEAR(passed[0].speed, 0.4, 0.015);
    EXPECT_NEAR(total_mass(simulation, scene), mass, 0.03 * mass);
    // What is there is what was there and what has entered, less what has left: to the particle.
    const double balance = mass + scene.fluid.density * (passed[0].volume - passed[1].volume);
    EXPECT_NEAR(total_mass(simulation, scene), balance, 1e-9 * mass);
  }
}

TEST(Openings, StillWaterStaysStill) {
  Scene scene = test::reach(2);
  scene.water.front().velocity = {};
  scene.openings[0].discharge = 0;
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  test::run(simulation, 1);
  const double mass = total_mass(simulation, scene);
  test::run(simulation, static_cast<int>(1.0 / simulation.window_length()));
  EXPECT_EQ(simulation.openings()->passages()[0].volume, 0);
  EXPECT_NEAR(total_mass(simulation, scene), mass, 0.02 * mass);
  EXPECT_LT(simulation.openings()->passages()[1].speed, 0.02);
}

TEST(Openings, AProfileCarriesTheSameDischarge) {
  for (const Profile profile : {Profile::power, Profile::parabolic}) {
    Scene scene = test::reach(2);
    scene.openings[0].profile = profile;
    scene.openings[0].level = 0.1;
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    test::run(simulation, static_cast<int>(0.5 / simulation.window_length()));
    double lowest = 1e9, highest = 0;  // of the zone
    for (std::size_t i = 0; i < simulation.particles().water; ++i) {
      const Record& record = simulation.particles().record[i];
      if (record.x[0] > -0.01) continue;
      lowest = std::min(lowest, record.v[0]);
      highest = std::max(highest, record.v[0]);
    }
    MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, &highest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    // The velocities of the ten rows over their mean: of eta^(1/7), and of eta (2 - eta), eta from 0.05 to 0.95.
    const bool power = profile == Profile::power;
    EXPECT_NEAR(lowest / 0.4, power ? 0.7433 : 0.1459, 0.01);
    EXPECT_NEAR(highest / 0.4, power ? 1.1319 : 1.4925, 0.01);
    const double asked = *scene.openings.front().discharge * simulation.time();
    EXPECT_NEAR(simulation.openings()->passages()[0].volume, asked, 0.01 * 0.1);
  }
}

TEST(Openings, TheLevelOfAnInflowThatIsGivenMakesItsDepth) {
  Scene scene = test::reach(2);
  scene.openings[0].level = 0.055;  // five rows and a half
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  test::run(simulation, static_cast<int>(0.4 / simulation.window_length()));
  EXPECT_DOUBLE_EQ(simulation.openings()->passages()[0].level, 0.055);
  EXPECT_NEAR(simulation.openings()->passages()[0].speed, 0.4 * 0.1 / 0.055, 1e-9);
  const double asked = *scene.openings.front().discharge * simulation.time();
  EXPECT_NEAR(simulation.openings()->passages()[0].volume, asked, 0.01 * 0.06);
}

TEST(Openings, IntoShallowWaterTheInflowIsAsDeepAsItsWavesAllow) {
  Scene scene = test::reach(2);
  scene.water.front().region.upper[1] = 0.02;
  scene.water.front().velocity = {};
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  const double critical = std::cbrt(0.04 * 0.04 / 9.81);
  EXPECT_NEAR(simulation.openings()->passages()[0].level, critical, 0.0011);
  test::run(simulation, static_cast<int>(0.3 / simulation.window_length()));
  EXPECT_GE(simulation.openings()->passages()[0].level, critical - 1e-12);
  EXPECT_LT(simulation.openings()->passages()[0].speed, 0.04 / critical + 1e-9);
}

TEST(Openings, ADrainTakesAwayWhatEntersIt) {
  Scene scene = test::collapsing_column(2, 20);
  scene.domain.upper = {0.5, 1, 0};
  Opening drain;
  drain.name = "gully";
  drain.kind = Opening::Kind::drain;
  drain.region = {{0.35, 0, 0}, {0.4, 0.1, 0}};
  scene.openings = {drain};
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  test::run(simulation, 1);
  const double mass = total_mass(simulation, scene);
  test::run(simulation, static_cast<int>(0.8 / simulation.window_length()));
  const double gone = scene.fluid.density * simulation.openings()->passages()[0].volume;
  EXPECT_GT(gone, 0.3 * mass);
  EXPECT_NEAR(total_mass(simulation, scene), mass - gone, 1e-9 * mass);
}

/// A reach so short and wide that ranks share its zones.
Scene wide_reach() {
  Scene scene = test::reach(3);
  const double width = 0.6, depth = 0.05, end = 0.2;
  scene.water.front().region.upper = {end, width, depth};
  scene.walls.front().region.upper = {end + 0.05, width, 0.2};
  scene.domain.upper[1] = std::max(scene.domain.upper[1], width + 0.1);
  for (Opening& opening : scene.openings) opening.region.upper[1] = width;
  scene.openings[0].discharge = 0.4 * depth * width;
  scene.openings[1].region.lower[0] = end - 0.05;
  scene.openings[1].region.upper[0] = end;
  scene.openings[1].level = depth;
  return scene;
}

void expect_no_trace_of_ranks(const Scene& scene, int windows) {
  const test::Result all = test::result_of(scene, MPI_COMM_WORLD, windows);
  const test::Result alone = test::result_of(scene, MPI_COMM_SELF, windows);
  EXPECT_EQ(all.state.particles, alone.state.particles);
  EXPECT_NEAR(all.state.energy.kinetic, alone.state.energy.kinetic, 1e-11 * alone.state.energy.kinetic);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(all.centre[c], alone.centre[c], 1e-12);
}

TEST(Openings, RanksDoNotShow) {
  expect_no_trace_of_ranks(test::reach(3), 150);
  expect_no_trace_of_ranks(wide_reach(), 100);
}

}  // namespace
}  // namespace embacle::mps
