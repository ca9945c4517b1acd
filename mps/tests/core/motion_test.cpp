// Walls that move and turn, and the central force.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/filling.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::Result;
using test::result_of;
using test::run;

TEST(Walls, AGateMovesAsPrescribed) {
  Motion constant;
  constant.velocity = {0, 0, 0.4};
  constant.start = 0.1;
  constant.stop = 0.6;
  EXPECT_EQ(displacement(constant, 0.05)[2], 0.0);
  EXPECT_NEAR(displacement(constant, 0.35)[2], 0.1, 1e-15);
  EXPECT_NEAR(displacement(constant, 2.0)[2], 0.2, 1e-15);
  Motion table;
  table.table = {{0.0, {0, 0, 0}}, {1.0, {0, 0, 1}}, {2.0, {0, 0, 5}}};
  EXPECT_NEAR(displacement(table, 1.5)[2], 3.0, 1e-15);
  EXPECT_NEAR(displacement(table, 9.0)[2], 5.0, 1e-15);
}

/// What was at x at time zero, by another way than the program's.
Eigen::Vector3d placed(const Motion& motion, const Vec3d& moved, double angle, const Vec3d& x) {
  const Eigen::Map<const Eigen::Vector3d> axis(motion.axis.data()), pivot(motion.pivot.data()), start(x.data()),
      shift(moved.data());
  return pivot + shift + Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * (start - pivot);
}

TEST(Walls, AFlapMovesFromItsTablesAsABruteForceSays) {
  for (const int dimension : {2, 3}) {
    Scene scene = test::still_tank(dimension, 12);
    scene.walls.front().region.upper[0] = 0.3;
    Wall flap;
    flap.name = "flap";
    flap.region.lower = {0.13, 0, 0};
    flap.region.upper = {0.17, 0.12, dimension == 3 ? 0.12 : 0.0};
    Motion& motion = flap.motion.emplace();
    motion.angle_table = {{0, 0}, {0.01, -0.1}, {0.05, 0.3}};
    motion.table = {{0, {}}, {0.03, {-0.02, 0.01, 0}}};
    motion.pivot = {0.15, -0.01, 0.06};
    if (dimension == 3) motion.axis = {0.6, 0, 0.8};
    scene.walls.push_back(flap);
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    run(simulation, 45);
    const std::vector<Walls::Point> tank = simulation.walls().points(0), points = simulation.walls().points(1);
    const auto at = [&](double time, const Vec3d& x) {
      const double angle = time < 0.01 ? -10 * time : -0.1 + 10 * (time - 0.01), share = time / 0.03;
      return placed(motion, {-0.02 * share, 0.01 * share, 0}, angle, x);
    };
    const double time = simulation.time(), step = simulation.constants().step;
    ASSERT_GT(time, 0.01);
    ASSERT_LT(time, 0.03);
    int found = 0;
    const Particles& particles = simulation.particles();
    for (std::size_t j = particles.water; j < particles.own(); ++j) {
      if (particles.identity[j].owner != 1) continue;
      ++found;
      const Vec3d& start = points[particles.identity[j].id - static_cast<std::int64_t>(tank.size())].x;
      const Eigen::Vector3d expected = at(time, start), before = at(time - step, start);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(particles.record[j].x[c], expected[c], 1e-13);
        EXPECT_NEAR(particles.record[j].v[c], (expected[c] - before[c]) / step, 1e-9);
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, &found, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_GT(found, 20);
    EXPECT_EQ(measure(simulation, scene).outside_tank, 0);
  }
}

TEST(Walls, AccelerationIsTheSecondDerivativeOfThePlace) {
  Motion motion;
  motion.interpolation = Interpolation::cubic;
  motion.table = {{0, {}}, {0.3, {0.1, 0, -0.2}}, {0.5, {0.4, 0.1, 0}}, {1.1, {0, -0.1, 0.1}}};
  motion.angle_table = {{0, 0}, {0.2, 0.4}, {0.7, -0.3}, {1, 0.1}};
  motion.pivot = {1, 2, 3};
  motion.axis = {2.0 / 3, -1.0 / 3, 2.0 / 3};
  const Course smooth(motion);
  for (const auto& [time, row] : motion.table) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(smooth.pose(time).moved[c], row[c], 1e-15);
  }
  Motion wheel = motion;
  wheel.table.clear();
  wheel.angle_table.clear();
  wheel.angular_velocity = 2;
  for (const Course& course : {smooth, Course(wheel)}) {
    ASSERT_TRUE(course.accelerates());
    const Vec3d start{1.5, 2.2, 2.1};
    const double h = 1e-4;
    for (const double time : {0.05, 0.25, 0.4, 0.65, 0.9}) {
      const Vec3d a = course.pose(time - h).place(start), b = course.pose(time).place(start),
                  c = course.pose(time + h).place(start), back = course.pose(time).zero(b);
      const Vec3d found = course.acceleration(time, b.data());
      for (int d = 0; d < 3; ++d) {
        EXPECT_NEAR(found[d], (a[d] - 2 * b[d] + c[d]) / (h * h), 1e-4);
        EXPECT_NEAR(back[d], start[d], 1e-14);
      }
    }
  }
  EXPECT_NEAR(smooth.pose(1e-5).moved[0], 0, 1e-8) << "begins at rest";
  motion.interpolation = Interpolation::linear;
  motion.angle_table.clear();
  EXPECT_FALSE(Course(motion).accelerates()) << "straight lines stay as they were";
}

TEST(Walls, ATankThatTurnsHoldsItsWater) {
  for (const int dimension : {2, 3}) {
    Scene scene = test::still_tank(dimension, dimension == 2 ? 12 : 8);
    scene.walls.front().open.clear();
    const double size = scene.water.front().region.upper[0];
    Motion& motion = scene.walls.front().motion.emplace();
    motion.angular_velocity = 8;
    motion.pivot = {0.5 * size, 0.2 * size, 0.5 * size};
    if (dimension == 3) motion.axis = {0, 1, 0};
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    run(simulation, dimension == 2 ? 400 : 120);
    EXPECT_GT(8 * simulation.time(), dimension == 2 ? 0.8 : 0.3);
    const WaterState state = measure(simulation, scene);
    EXPECT_EQ(state.outside_tank, 0) << state.farthest_outside_tank;
    EXPECT_LT(std::abs(state.volume_ratio - 1), 0.05);
  }
}

TEST(Walls, ADryWallThatTurnsIntoTheWaterIsNoticed) {
  Scene scene = test::still_tank(2, 12);
  Wall flap;
  flap.name = "flap";
  flap.region.lower = {0.04, 0.24, 0};
  flap.region.upper = {0.3, 0.28, 0};
  Motion& motion = flap.motion.emplace();
  motion.angular_velocity = 8;  // its far end comes down
  motion.pivot = {0.3, 0.26, 0};
  scene.walls.push_back(flap);
  Simulation simulation(scene, MPI_COMM_SELF, nullptr);
  const std::size_t first = simulation.walls().points(0).size();
  const std::vector<Walls::Point> points = simulation.walls().points(1);
  const double reach = simulation.constants().support;
  std::size_t wet = 0, missing = 0;
  while (simulation.time() < 0.065) {
    run(simulation, 10);
    const Particles& particles = simulation.particles();
    std::set<std::int64_t> listed;
    for (std::size_t j = particles.water; j < particles.own(); ++j) listed.insert(particles.identity[j].id);
    const Pose pose = simulation.walls().course(1).pose(simulation.time());
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3d place = pose.place(points[k].x);
      bool near = false;
      for (std::size_t i = 0; i < particles.water && !near; ++i) {
        const double* x = particles.record[i].x;
        near = std::hypot(x[0] - place[0], x[1] - place[1]) < reach;
      }
      wet += near ? 1 : 0;
      missing += near && !listed.contains(static_cast<std::int64_t>(first + k)) ? 1 : 0;
    }
  }
  EXPECT_GT(wet, 30U);
  EXPECT_EQ(missing, 0U);
}

TEST(Walls, TheirPressureHasTheirAcceleration) {
  for (const bool central : {false, true}) {
    Scene scene = test::still_tank(2, 10);
    Motion& motion = scene.walls.front().motion.emplace();
    motion.interpolation = Interpolation::cubic;
    motion.table = {{0, {}}, {0.01, {0.001, 0, 0}}, {0.1, {0.02, 0.01, 0}}};
    motion.angular_velocity = 3;
    motion.pivot = {0.05, 0.3, 0};
    scene.fluid.central_force = central ? 20 : 0;
    scene.fluid.central_force_centre = {0.05, 0.08, 0};
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    run(simulation, 20);
    const Constants& constants = simulation.constants();
    const Particles& particles = simulation.particles();
    const Course course(motion);
    const Kernel<KernelKind::wendland> kernel{1 / constants.support};
    int wet = 0;
    for (std::size_t b = particles.water; b < particles.own(); ++b) {
      const Record& point = particles.record[b];
      const Vec3d a = course.acceleration(simulation.time(), point.x);
      double weights = 0, sum = 0;
      for (std::size_t i = 0; i < particles.water; ++i) {
        const Record& water = particles.record[i];
        const double d[2] = {point.x[0] - water.x[0], point.x[1] - water.x[1]};
        const double r = std::hypot(d[0], d[1]);
        if (r >= constants.support) continue;
        double head = 0;
        for (int c = 0; c < 2; ++c) {
          const double pull = central ? -20 * (point.x[c] - constants.centre[c]) : 0.0;
          head += (constants.gravity[c] + pull - a[c]) * d[c];
        }
        weights += kernel.gradient_weight(r);
        sum += kernel.gradient_weight(r) * (water.p + constants.density * head);
      }
      if (weights == 0) continue;
      ++wet;
      EXPECT_NEAR(point.p, std::max(0.0, sum / weights), 1e-6);
    }
    EXPECT_GT(wet, 30);
  }
}

/// A disc of water in its equilibrium under a central force, as a table.
Scene central_drop(double radius, Vec3d velocity) {
  Scene scene = test::still_tank(2, 10);
  scene.walls.clear();
  scene.fluid.gravity = {};
  scene.fluid.central_force = 30;
  scene.fluid.central_force_centre = {0.2, 0.1, 0};
  scene.numerics.reference_speed = 1;
  Water& water = scene.water.front();
  water.kind = Water::Kind::table;
  water.table.has_pressure = water.table.has_velocity = true;
  for (int j = -20; j < 20; ++j) {
    for (int i = -20; i < 20; ++i) {
      const double x = (i + 0.5) * 0.01, y = (j + 0.5) * 0.01, square = x * x + y * y;
      if (square > radius * radius) continue;
      water.table.rows.push_back({{0.2 + x, 0.1 + y, 0}, velocity, 500 * 30 * (radius * radius - square)});
    }
  }
  return scene;
}

TEST(CentralForce, TheCentreOfADropSwingsAsAPendulum) {
  // Pair forces cancel in the sum: the centre of mass obeys the leapfrog of one point, to round-off.
  Scene scene = central_drop(0.08, {0.3, -0.1, 0});
  scene.fluid.central_force_centre = {0.15, 0.12, 0};
  scene.output.audit = true;
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  const double step = simulation.constants().step;
  run(simulation, 200);
  double x[2] = {0.2, 0.1}, v[2] = {0.3, -0.1};
  for (int k = 0; k < 200; ++k) {
    for (int c = 0; c < 2; ++c) {
      x[c] += step * v[c];
      v[c] -= step * 30 * (x[c] - scene.fluid.central_force_centre[c]);
    }
  }
  const Result result = result_of(scene, MPI_COMM_WORLD, 200);
  double potential = 0;
  for (std::size_t i = 0; i < simulation.particles().water; ++i) {
    const double* place = simulation.particles().record[i].x;
    potential +=
        15 * simulation.constants().particle_mass * (std::pow(place[0] - 0.15, 2) + std::pow(place[1] - 0.12, 2));
  }
  MPI_Allreduce(MPI_IN_PLACE, &potential, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(result.centre[c], x[c], 1e-12);
    const double in_time = v[c] + 0.5 * step * 30 * (x[c] - scene.fluid.central_force_centre[c]);
    EXPECT_NEAR(result.state.momentum[c] / result.state.mass, in_time, 1e-11);
  }
  EXPECT_NEAR(measure(simulation, scene).energy.potential, potential, 1e-9 * potential);
}

TEST(CentralForce, ADropAtRestKeepsItsSizeUnderDensityDiffusion) {
  // With its hydrostatic part the diffusion would make the water denser and denser, so that the drop shrinks.
  Scene scene = central_drop(0.1, {});
  scene.numerics.density_diffusion = 1;
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 1);
  const double potential = measure(simulation, scene).energy.potential;
  run(simulation, 800);
  EXPECT_NEAR(measure(simulation, scene).energy.potential, potential, 0.003 * potential);
}

}  // namespace
}  // namespace embacle::mps
