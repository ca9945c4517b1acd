// Friction on walls: exact for linear profiles, the opposite force on the wall, slip, moving surfaces, the time step.
#include <gtest/gtest.h>

#include <cmath>

#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::Result;
using test::result_of;

constexpr double l0 = 0.01;
constexpr int layers = 12;

/// Shear between two plates across y, from rest below to `speed` along x above, endless in the other directions. The
/// lower plate is a tank, the upper one a box.
Scene shear(int dimension, double speed) {
  Scene scene = test::still_tank(dimension, layers, l0);
  const double height = layers * l0;
  const double depth = dimension == 3 ? height : 0.0;
  scene.fluid.gravity = {};
  scene.fluid.kinematic_viscosity = 1e-3;
  scene.numerics.reference_speed = 1;
  scene.numerics.artificial_viscosity = 0;
  scene.periodic = {"x"};
  if (dimension == 3) scene.periodic.emplace_back("z");
  scene.domain = {{0, -0.1, 0}, {height, height + 0.1, depth}};
  Wall& below = scene.walls.front();
  below.region.upper = {height, height, depth};
  below.open = {"x-", "x+", "y+"};
  if (dimension == 3) below.open.insert(below.open.end(), {"z-", "z+"});
  below.slip = false;
  Wall lid;
  lid.name = "lid";
  lid.region = {{0, height, 0}, {height, height + 4 * l0, depth}};
  lid.slip = false;
  lid.motion.emplace();
  lid.motion->surface_velocity = {speed, 0, 0};
  scene.walls.push_back(lid);
  Water& water = scene.water.front();
  water.kind = Water::Kind::table;
  water.table.has_velocity = true;
  for (int k = 0; k < (dimension == 3 ? layers : 1); ++k) {
    for (int j = 0; j < layers; ++j) {
      for (int i = 0; i < layers; ++i) {
        const double y = (j + 0.5) * l0;
        water.table.rows.push_back(
            {{(i + 0.5) * l0, y, dimension == 3 ? (k + 0.5) * l0 : 0.0}, {speed * y / height, 0, 0}});
      }
    }
  }
  return scene;
}

struct Forces {
  std::vector<Triple> acceleration;
  Reactions reaction;
  Triple on_water{}, on_walls{};  ///< of this rank [N]
};

/// Viscous forces at the start.
Forces forces_of(Simulation& simulation, const Scene& scene) {
  (void)simulation.begin_epoch(1);
  Forces forces;
  accelerate(simulation.particles(), simulation.neighbours(), simulation.constants(), forces.acceleration,
             forces.reaction);
  const Friction friction(scene, simulation.constants(), simulation.walls());
  friction.apply(simulation.particles(), simulation.neighbours(), 0, forces.acceleration, forces.reaction);
  for (int c = 0; c < 3; ++c) {
    for (const Triple& a : forces.acceleration) forces.on_water[c] += simulation.constants().particle_mass * a[c];
    for (const Triple& r : forces.reaction.total()) forces.on_walls[c] += r[c];
  }
  return forces;
}

TEST(Friction, ALinearProfileFeelsNoForceAnywhere) {
  for (const int dimension : {2, 3}) {
    for (const KernelKind kernel : {KernelKind::wendland, KernelKind::rational}) {
      Scene scene = shear(dimension, 0.5);
      scene.numerics.kernel = kernel;
      Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
      const Forces forces = forces_of(simulation, scene);
      const double scale = scene.fluid.kinematic_viscosity * 0.5 / (l0 * l0);
      for (const Triple& a : forces.acceleration) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], 0, 1e-12 * scale);
      }
    }
  }
}

TEST(Friction, TheWallsFeelTheShearStressAndItsOpposite) {
  for (const int dimension : {2, 3}) {
    Scene scene = shear(dimension, 0.5);
    scene.walls.back().motion->surface_velocity = {-0.5, 0, 0};  // against the water
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    const Forces forces = forces_of(simulation, scene);
    double sums[4] = {forces.on_water[0], forces.on_walls[0], forces.on_water[1], forces.on_walls[1]};
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_LT(sums[0], 0);
    EXPECT_NEAR(sums[0], -sums[1], 1e-12 * std::abs(sums[0]));
    EXPECT_NEAR(sums[2], 0, 1e-12 * std::abs(sums[0]));
    // With the velocity that belongs to the profile the lid feels rho nu U/H.
    scene = shear(dimension, 0.5);
    Simulation steady(scene, MPI_COMM_WORLD, nullptr);
    const Forces balance = forces_of(steady, scene);
    double on_lid = 0;
    for (std::size_t j = steady.particles().water; j < steady.particles().all(); ++j) {
      if (steady.particles().is_water(j) || steady.particles().identity[j].owner != 1) continue;
      on_lid += balance.reaction.total()[reaction_slot(steady.particles(), j)][0];
    }
    MPI_Allreduce(MPI_IN_PLACE, &on_lid, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    const double area = layers * l0 * (dimension == 3 ? layers * l0 : 1.0);
    EXPECT_NEAR(on_lid, -1000 * 1e-3 * 0.5 / (layers * l0) * area, 1e-10);
  }
}

TEST(Friction, ChannelsConserveMomentumAndAreTheSameOnAnyNumberOfRanks) {
  Scene scene = shear(2, 0.5);
  for (WaterTable::Row& row : scene.water.front().table.rows) row.velocity = {0.2, 0, 0};
  scene.fluid.gravity = {0.5, 0, 0};
  scene.output.audit = true;
  const Result parallel = result_of(scene, MPI_COMM_WORLD, 100);
  const Result alone = result_of(scene, MPI_COMM_SELF, 100);
  EXPECT_NEAR(parallel.state.momentum[0], alone.state.momentum[0], 1e-10 * alone.state.momentum[0]);
  EXPECT_LT(parallel.audit.momentum_residual, 1e-10);
  EXPECT_GT(parallel.audit.momentum_residual, 0);
}

TEST(Friction, WaterSlipsWhereTheWallLetsIt) {
  Scene scene = shear(2, 0.5);
  scene.walls.back().motion.reset();
  for (WaterTable::Row& row : scene.water.front().table.rows) row.velocity = {0.3, 0, 0};
  const auto speed = [&](std::optional<bool> slip) {
    for (Wall& wall : scene.walls) wall.slip = slip;
    const WaterState state = result_of(scene, MPI_COMM_WORLD, 100).state;
    return state.momentum[0] / state.mass;
  };
  EXPECT_NEAR(speed(true), 0.3, 1e-7) << "but for the steps from wall point to wall point";
  const double sticking = speed(false);
  EXPECT_LT(sticking, 0.28);
  EXPECT_NEAR(speed(std::nullopt), sticking, 0.01) << "mirrored velocities are nearly the same";
}

TEST(Friction, DistancesAreAlongTheNormal) {
  Scene scene = test::still_tank(2, 10, l0);
  Wall box;
  box.region = {{0.2, 0, 0}, {0.3, 0.1, 0}};
  scene.walls.push_back(box);
  Wall gate;  // thinner than the support, across x
  gate.region = {{0.5, 0, 0}, {0.51, 0.1, 0}};
  scene.walls.push_back(gate);
  Wall pole;
  pole.kind = Wall::Kind::cylinder;
  pole.form.kind = Form::Kind::cylinder;
  pole.form.centre = {0.8, 0.1, 0};
  pole.form.radius = 0.05;
  pole.region = bounds(pole.form, 2);
  scene.walls.push_back(pole);
  const Walls walls(scene, 2, 3);
  const auto distances = [&](int wall, int side, Vec3d moved, Vec3d point, Vec3d water) {
    Pose pose;
    pose.moved = moved;
    return walls.distances(wall, side, pose, point.data(), water.data(), Periodic{});
  };
  const auto expect = [](const Walls::Distances& d, double point, double water) {
    EXPECT_NEAR(d.point, point, 1e-14);
    EXPECT_NEAR(d.water, water, 1e-14);
  };
  expect(distances(0, both, {}, {0.03, -0.015, 0}, {0.05, 0.005, 0}), 0.015, 0.005);   // floor
  expect(distances(0, both, {}, {0.03, -0.015, 0}, {0.001, 0.005, 0}), 0.015, 0.005);  // floor, although near the side
  const double root = std::sqrt(2.0);
  expect(distances(0, both, {}, {-0.01, -0.01, 0}, {0.02, 0.02, 0}), 0.01 * root, 0.02 * root);   // out of the corner
  expect(distances(1, both, {}, {0.295, 0.095, 0}, {0.31, 0.095, 0}), 0.005, 0.01);               // face of a box
  expect(distances(1, both, {}, {0.295, 0.095, 0}, {0.31, 0.11, 0}), 0.005 * root, 0.01 * root);  // edge of a box
  expect(distances(1, both, {0.1, 0, 0}, {0.395, 0.05, 0}, {0.41, 0.05, 0}), 0.005, 0.01);        // moved
  expect(distances(2, plus_extra, {}, {0.485, 0.05, 0}, {0.515, 0.05, 0}), 0.025, 0.005);
  expect(distances(2, minus, {}, {0.505, 0.05, 0}, {0.495, 0.05, 0}), 0.005, 0.005);
  expect(distances(3, both, {}, {0.8, 0.145, 0}, {0.8, 0.16, 0}), 0.005, 0.01);
  expect(distances(3, both, {0, 0.1, 0}, {0.82, 0.245, 0}, {0.8, 0.26, 0}), 0.005, 0.01);  // along the water's normal
  Periodic periodic;
  periodic.length = {1, 0, 0};
  const Vec3d point{1.205, 0.05, 0}, water{1.19, 0.05, 0};  // an image of the box
  expect(walls.distances(1, both, {}, point.data(), water.data(), periodic), 0.005, 0.01);
}

TEST(Friction, TheTimeStepKeepsToTheShortestLimit) {
  Scene scene = shear(2, 0.5);
  const Constants acoustic = constants_of(scene);
  EXPECT_STREQ(name_of(acoustic.step_limit), "acoustic");
  EXPECT_EQ(acoustic.step, 0.5 * l0 / 11);
  scene.fluid.kinematic_viscosity = 1;
  EXPECT_STREQ(name_of(constants_of(scene).step_limit), "viscous");
  EXPECT_NEAR(constants_of(scene).step, 0.125 * l0 * l0, 1e-18);
  scene.fluid.gravity = {1e8, 0, 0};
  EXPECT_STREQ(name_of(constants_of(scene).step_limit), "force");
  EXPECT_NEAR(constants_of(scene).step, 0.25 * std::sqrt(l0 / 1e8), 1e-18);
}

}  // namespace
}  // namespace embacle::mps
