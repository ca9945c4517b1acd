// The whole time step: rest, conservation, symmetry, and the same result on any number of ranks.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <set>

#include "core/filling.hpp"
#include "core/surface_loads.hpp"
#include "core/turbulence.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::Result;
using test::result_of;
using test::run;

TEST(Simulation, SameResultOnAnyNumberOfRanks) {
  for (const int dimension : {2, 3}) {
    const Scene scene = test::collapsing_column(dimension, dimension == 3 ? 10 : 24);
    const Result parallel = result_of(scene, MPI_COMM_WORLD, 200);
    const Result alone = result_of(scene, MPI_COMM_SELF, 200);
    EXPECT_EQ(parallel.state.particles, alone.state.particles);
    EXPECT_GT(alone.state.energy.kinetic, 1e-4 * alone.state.energy.potential);
    EXPECT_NEAR(parallel.state.energy.kinetic, alone.state.energy.kinetic, 1e-9 * alone.state.energy.kinetic);
    EXPECT_NEAR(parallel.state.energy.potential, alone.state.energy.potential, 1e-11 * alone.state.energy.potential);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(parallel.centre[c], alone.centre[c], 1e-11);
  }
}

TEST(Simulation, AnyNumberOfThreadsGivesTheSameParticles) {
  const Scene scene = test::collapsing_column(3, 10);
  const auto after = [&](int count) {
    set_threads(count);
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    run(simulation, 150);
    set_threads(1);
    return simulation.particles().record;
  };
  const std::vector<Record> alone = after(1), shared = after(3);
  ASSERT_EQ(alone.size(), shared.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_EQ(alone[i].x[c], shared[i].x[c]);
    EXPECT_EQ(alone[i].p, shared[i].p);
  }
}

TEST(Threads, SumsAreJoinedAndErrorsPassedOn) {
  set_threads(4);
  ThreadSums<Triple> sums;
  for (const std::size_t n : {std::size_t{7}, std::size_t{3}, std::size_t{1000}}) {
    sums.reset(n);
    for_each(100 * n, [&](std::size_t k, int thread) { sums.of_thread(thread)[k % n][1] += 1; });
    sums.join();
    for (const Triple& sum : sums.total()) EXPECT_EQ(sum, (Triple{0, 100, 0}));
  }
  EXPECT_THROW(for_each(100,
                        [](std::size_t k, int) {
                          if (k == 99) throw coupling::InstabilityError("of the last thread");
                        }),
               coupling::InstabilityError);
  set_threads(1);
}

TEST(Simulation, MomentumChangesByGravityAndWallsOnly) {
  const Result result = result_of(test::collapsing_column(3, 10), MPI_COMM_WORLD, 100);
  EXPECT_LT(result.audit.momentum_residual, 1e-10);
  EXPECT_GT(result.audit.momentum_residual, 0.0);  // it was measured
}

TEST(Simulation, EnergyOnlyFallsWhenWhatWallsStoreIsCounted) {
  // The front hits the far wall, which takes up energy and gives part of it back.
  const Scene scene = test::collapsing_column(2, 12);
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 1);
  double start = 0, lowest = 1e300, lowest_of_water = 1e300, rise = 0, rise_of_water = 0, least = 0, most = 0;
  for (int k = 0; k < 900; ++k) {
    run(simulation, 1);
    const Energies energy = measure(simulation, scene).energy;
    const double total = energy.total(), of_water = total - energy.in_solids;
    if (k == 0) start = total;
    lowest = std::min(lowest, total);
    lowest_of_water = std::min(lowest_of_water, of_water);
    rise = std::max(rise, total - lowest);
    rise_of_water = std::max(rise_of_water, of_water - lowest_of_water);
    least = std::min(least, energy.in_solids);
    most = std::max(most, energy.in_solids);
  }
  const double loss = start - lowest;
  EXPECT_GT(rise_of_water, 3e-4 * loss);
  EXPECT_LT(rise, 1e-4 * loss);
  EXPECT_GT(most, 0.01 * loss);
  EXPECT_GT(least, -0.01 * loss);  // they hardly give back more than they took
}

TEST(Simulation, FreeFlightKeepsMomentumAndCentre) {
  // No walls, no gravity: a turning drop keeps linear momentum, and its centre moves straight.
  Scene scene = test::still_tank(3, 8);
  scene.walls.clear();
  scene.fluid.gravity = {0, 0, 0};
  scene.water.front().velocity = {0.3, -0.2, 0.1};
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 100);
  const Result after = result_of(scene, MPI_COMM_WORLD, 100);
  const double time = simulation.time();
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(after.state.momentum[c] / after.state.mass, scene.water.front().velocity[c], 1e-13);
    EXPECT_NEAR(after.centre[c] - 0.04, scene.water.front().velocity[c] * time, 1e-12);
  }
}

TEST(Simulation, WallsHaveADensityOfTheirOwn) {
  // The same on any number of ranks, and the pressure of still water holds without extrapolation.
  Scene scene = test::collapsing_column(2, 24);
  scene.numerics.wall_pressure = WallPressure::continuity;
  const Result parallel = result_of(scene, MPI_COMM_WORLD, 200);
  const Result alone = result_of(scene, MPI_COMM_SELF, 200);
  scene.numerics.wall_pressure = WallPressure::extrapolated;
  const Result other = result_of(scene, MPI_COMM_SELF, 200);
  const double kinetic = alone.state.energy.kinetic;
  EXPECT_NEAR(parallel.state.energy.kinetic, kinetic, 1e-9 * kinetic);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(parallel.centre[c], alone.centre[c], 1e-11);
  EXPECT_NEAR(other.state.energy.kinetic, kinetic, 0.1 * kinetic);
  EXPECT_GT(std::abs(other.state.energy.kinetic - kinetic), 1e-6 * kinetic);
  scene = test::still_tank(2, 10);
  scene.numerics.wall_pressure = WallPressure::continuity;
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 400);
  Gauge bottom;
  bottom.kind = GaugeKind::pressure;
  bottom.position = {0.05, 0.005, 0};
  EXPECT_NEAR(pressure_at(simulation, bottom), 1000 * 9.81 * 0.095, 0.1 * 1000 * 9.81 * 0.1);
}

TEST(Simulation, TheSymplecticIntegratorIsOfSecondOrder) {
  // A drop that swings between compression and expansion: the error after the same time, against a step of a sixteenth,
  // falls with the square of the step. Without collisions, which are not smooth.
  const auto state_after = [](int refinement) {
    Scene scene = test::still_tank(2, 6);
    scene.walls.clear();
    scene.fluid.gravity = {};
    scene.fluid.kinematic_viscosity = 1e-3;
    scene.numerics.density_diffusion = 0;  // of first order
    scene.numerics.sound_speed = 10;
    scene.numerics.reference_speed = 1;
    scene.numerics.regularisation = Regularisation::none;
    scene.numerics.integrator = Integrator::symplectic;
    scene.numerics.cfl = 0.2 / refinement;
    Water& water = scene.water.front();
    water.kind = Water::Kind::table;
    water.table.has_velocity = true;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) {
        const double x = (i + 0.5) * 0.01, y = (j + 0.5) * 0.01;
        water.table.rows.push_back({{x, y, 0}, {0.1 * std::sin(80 * y), 0.1 * std::cos(60 * x), 0}});
      }
    }
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    run(simulation, 20 * refinement);
    std::vector<double> state(4 * 36);
    for (std::size_t i = 0; i < 36; ++i) {
      const Record& record = simulation.particles().record[i];
      const std::size_t row = 4 * static_cast<std::size_t>(simulation.particles().identity[i].id);
      for (int c = 0; c < 2; ++c) {
        state[row + c] = record.x[c] / 0.01;
        state[row + 2 + c] = record.v[c] / 0.1;
      }
    }
    return state;
  };
  const auto exact = state_after(16);
  const auto error = [&](const std::vector<double>& state) {
    double sum = 0;
    for (std::size_t k = 0; k < state.size(); ++k) sum += std::pow(state[k] - exact[k], 2);
    return std::sqrt(sum);
  };
  const double coarse = error(state_after(1)), fine = error(state_after(2));
  EXPECT_GT(coarse, 3.3 * fine);
  EXPECT_LT(coarse, 0.1);
}

TEST(Simulation, TheSymplecticIntegratorGivesTheSameOnAnyNumberOfRanks) {
  Scene scene = test::collapsing_column(2, 24);
  scene.numerics.integrator = Integrator::symplectic;
  const Result parallel = result_of(scene, MPI_COMM_WORLD, 200);
  const Result alone = result_of(scene, MPI_COMM_SELF, 200);
  scene.numerics.integrator = Integrator::leapfrog;
  const Result other = result_of(scene, MPI_COMM_SELF, 200);
  const double kinetic = alone.state.energy.kinetic;
  EXPECT_NEAR(parallel.state.energy.kinetic, kinetic, 1e-9 * kinetic);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(parallel.centre[c], alone.centre[c], 1e-11);
  EXPECT_LT(parallel.audit.momentum_residual, 1e-10);
  EXPECT_NEAR(other.state.energy.kinetic, kinetic, 0.05 * kinetic);
}

TEST(Simulation, PressureOfWallsWithoutGradientIsThatOfTheWaterAround) {
  const auto under_the_bottom = [](WallPressure kind) {
    Scene scene = test::still_tank(2, 10);
    scene.numerics.wall_pressure = kind;
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    run(simulation, 1);
    for (std::size_t j = simulation.particles().water; j < simulation.particles().own(); ++j) {
      const Record& record = simulation.particles().record[j];
      if (std::abs(record.x[0] - 0.055) < 1e-6 && std::abs(record.x[1] + 0.005) < 1e-6) return record.p;
    }
    return 0.0;
  };
  const double row = 1000 * 9.81 * 0.01;  // rise of the pressure over a row
  EXPECT_NEAR(under_the_bottom(WallPressure::extrapolated), 10.5 * row, 0.2 * row);
  EXPECT_NEAR(under_the_bottom(WallPressure::zero_gradient), 9 * row, 0.45 * row);  // of the two or three rows seen
}

TEST(Simulation, StillWaterStaysStill) {
  for (const int dimension : {2, 3}) {
    const Scene scene = test::still_tank(dimension, 10);
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    run(simulation, 400);
    const WaterState state = measure(simulation, scene);
    EXPECT_LT(state.energy.kinetic, 1e-4 * state.mass * 9.81 * 0.1);
    EXPECT_EQ(state.outside_tank, 0);
    Gauge bottom;
    bottom.kind = GaugeKind::pressure;
    bottom.position = {0.05, dimension == 3 ? 0.05 : 0.005, dimension == 3 ? 0.005 : 0.0};
    EXPECT_NEAR(pressure_at(simulation, bottom), 1000 * 9.81 * 0.095, 0.03 * 1000 * 9.81 * 0.1);
    Gauge level;
    level.position = bottom.position;
    EXPECT_NEAR(water_level(simulation, scene, level), 0.1, 0.002);
  }
}

TEST(Simulation, PlainDiffusionAlsoSmoothsTheHydrostaticDensity) {
  // Still water of hydrostatic density: the top row, whose neighbours are all denser or as dense, gains density by the
  // plain Laplacian, and none by that of the dynamic density (their difference: the Tait equation to first order).
  const auto gain_of_top = [](Diffusion diffusion) {
    Scene scene = test::still_tank(2, 10);
    scene.numerics.diffusion = diffusion;
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    (void)simulation.begin_epoch(1);
    Particles particles = simulation.particles();
    advance_density(particles, simulation.neighbours(), simulation.constants());
    double gain = 0;
    for (std::size_t i = 0; i < particles.water; ++i) {
      if (particles.record[i].x[1] < 0.09) continue;
      gain += (particles.record[i].s - simulation.particles().record[i].s) / 10;
    }
    return gain;
  };
  const Constants c = constants_of(test::still_tank(2, 10));
  const double row = 9.81 * c.particle_distance / (c.sound_speed * c.sound_speed);  // rise of s over a row
  EXPECT_NEAR(gain_of_top(Diffusion::dynamic), 0, 1e-3 * row);
  EXPECT_GT(gain_of_top(Diffusion::plain), 1e-2 * row);
}

TEST(Simulation, WithoutRegularisationParticlesPassThrough) {
  // Two particles that meet head-on, too slowly for the pressure to part them: a collision takes half of their speed.
  const auto speed_after = [](Regularisation regularisation) {
    Scene scene = test::still_tank(2, 4);
    scene.walls.clear();
    scene.fluid.gravity = {};
    scene.numerics.sound_speed = 1;
    scene.numerics.reference_speed = 0.1;
    scene.numerics.artificial_viscosity = 0;
    scene.numerics.density_diffusion = 0;
    scene.numerics.regularisation = regularisation;
    Water& water = scene.water.front();
    water.kind = Water::Kind::table;
    water.table.has_velocity = true;
    water.table.rows = {{{0, 0.5, 0}, {0.001, 0, 0}}, {{0.008, 0.5, 0}, {-0.001, 0, 0}}};
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    run(simulation, 1);
    return std::abs(simulation.particles().record[0].v[0]);
  };
  EXPECT_NEAR(speed_after(Regularisation::none), 0.001, 5e-5);
  EXPECT_NEAR(speed_after(Regularisation::collision), 0.0005, 5e-5);
}

TEST(Simulation, MirroredColumnsStayMirrored) {
  // Two columns at both ends of a tank: the left half mirrors the right one.
  Scene scene = test::still_tank(2, 10);
  scene.walls.front().region.upper[0] = 0.4;
  Water right = scene.water.front();
  right.name = "right";
  right.region.lower[0] = 0.3;
  right.region.upper[0] = 0.4;
  scene.water.push_back(right);
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 150);
  const WaterState state = measure(simulation, scene);
  EXPECT_NEAR(state.momentum[0], 0, 1e-9 * std::sqrt(2 * state.mass * state.energy.kinetic));
  EXPECT_GT(state.energy.kinetic, 0);
}

TEST(Simulation, AdaptiveStepsAreShorterWhileWaterIsFasterThanExpected) {
  // A column that falls onto a floor three times faster than the scene says.
  Scene scene = test::collapsing_column(2, 12);
  scene.numerics.reference_speed = 1;
  scene.numerics.sound_speed = 20;
  scene.numerics.adaptive_step = true;
  scene.water.front().velocity = {0, -3, 0};
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 60);
  const double usual = simulation.longest_step();
  EXPECT_NEAR(simulation.time(), 60 * usual, 1e-9);  // windows keep their length
  EXPECT_GT(simulation.counters().steps, 60);
  const double at_start = 0.5 * 0.01 / (20 + 3);
  EXPECT_LE(simulation.extremes().shortest_step, at_start);
  std::int64_t limited = 0;
  for (const std::int64_t steps : simulation.counters().limited_steps) limited += steps;
  EXPECT_GT(limited, 0);
  EXPECT_EQ(simulation.counters().limited_steps[static_cast<std::size_t>(StepLimit::viscous)], 0);

  scene.numerics.adaptive_step = false;
  Simulation fixed(scene, MPI_COMM_WORLD, nullptr);
  run(fixed, 60);
  EXPECT_EQ(fixed.counters().steps, 60);
}

TEST(Simulation, ABrokenRunNamesStepPlaceAndQuantity) {
  Scene scene = test::collapsing_column(2, 10);
  scene.numerics.cfl = 8;  // far beyond the stability limit
  Simulation simulation(scene, MPI_COMM_SELF, nullptr);
  try {
    run(simulation, 3000);
    FAIL() << "an unstable time step went unnoticed";
  } catch (const coupling::InstabilityError& error) {
    const std::string message = error.what();
    for (const char* word : {"step", "t =", "speed", " m", "particle"})
      EXPECT_NE(message.find(word), std::string::npos) << message;
  }
}

TEST(Simulation, WaterFromATableIsTheSameWater) {
  // The lattice of the box, once filled and once row by row.
  const Scene box = test::collapsing_column(2, 12);
  Scene table = box;
  Water& water = table.water.front();
  water.kind = Water::Kind::table;
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) water.table.rows.push_back({{(i + 0.5) * 0.01, (j + 0.5) * 0.01, 0}});
  }
  const Result filled = result_of(box, MPI_COMM_WORLD, 100);
  const Result read = result_of(table, MPI_COMM_WORLD, 100);
  EXPECT_EQ(read.state.particles, filled.state.particles);
  EXPECT_NEAR(read.state.energy.kinetic, filled.state.energy.kinetic, 1e-10 * filled.state.energy.kinetic);
  EXPECT_NEAR(read.state.energy.elastic, filled.state.energy.elastic, 1e-9 * filled.state.energy.elastic);
}

TEST(Simulation, ATableGivesVelocityAndPressure) {
  Scene scene = test::still_tank(2, 4);
  scene.walls.clear();
  scene.numerics.sound_speed = 20;
  Water& water = scene.water.front();
  water.kind = Water::Kind::table;
  water.table.has_velocity = water.table.has_pressure = true;
  for (int i = 0; i < 5; ++i) water.table.rows.push_back({{0.1 * i, 0.5, 0}, {0.1 * i, -1, 0}, 100.0 * i - 200, i + 2});
  const Constants constants = constants_of(scene);
  EXPECT_NEAR(constants.reference_speed, std::sqrt(1 + 0.16), 1e-15);
  const Walls walls(scene, 2, constants.layers);
  std::int64_t count = 0;
  for (int rank = 0; rank < 3; ++rank) {
    for (const Traveller& particle : fill(scene, constants, walls, rank, 3).water) {
      const Record& record = particle.record;
      const WaterTable::Row& row = water.table.rows[particle.identity.id];
      ++count;
      EXPECT_EQ(particle.identity.id % 3, rank);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(record.x[c], row.position[c]);
      for (int c = 0; c < 3; ++c) EXPECT_EQ(record.v[c], row.velocity[c]);
      EXPECT_NEAR(pressure_of(record.s, constants), row.pressure, 1e-8);
    }
  }
  EXPECT_EQ(count, 5);
  water.table.rows.back().pressure = 1e6;
  EXPECT_THROW((void)fill(scene, constants, walls, 0, 1), coupling::InputError);
}

/// Water off the lattice by a fifth of a particle distance, moving by `field`, and what turbulence adds to it.
struct Sheared {
  template <class Field>
  Sheared(int dimension, const Field& field) {
    Scene scene = test::still_tank(dimension, dimension == 3 ? 8 : 16);
    scene.walls.clear();
    scene.fluid.gravity = {};
    scene.numerics.reference_speed = 1;
    scene.numerics.turbulence = TurbulenceModel::smagorinsky;
    scene.numerics.smagorinsky = 0.2;
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    (void)simulation.begin_epoch(1);
    particles = simulation.particles();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> off(-0.002, 0.002);
    for (std::size_t i = 0; i < particles.water; ++i) {
      for (int c = 0; c < dimension; ++c) particles.record[i].x[c] += off(random);
      const Vec3d v = field(particles.record[i].x);
      std::copy_n(v.begin(), 3, particles.record[i].v);
    }
    Halo halo = simulation.halo();
    halo.update_motion(particles);
    constants = simulation.constants();
    Turbulence turbulence(constants);
    acceleration.assign(particles.water, {});
    turbulence.apply(particles, simulation.neighbours(), halo, acceleration);
    viscosity = turbulence.viscosity();
  }
  Constants constants;
  Particles particles;
  std::vector<Triple> acceleration;
  std::vector<double> viscosity;
};

TEST(Turbulence, EddyViscosityOfAUniformShearIsExact) {
  for (const int dimension : {2, 3}) {
    const double gradient[3][3] = {{1, 2, 3}, {-4, -1, 5}, {2, 0.5, 0}};
    const Sheared sheared(dimension, [&](const double* x) {
      Vec3d v{};
      for (int a = 0; a < dimension; ++a) {
        for (int b = 0; b < dimension; ++b) v[a] += gradient[a][b] * x[b];
      }
      return v;
    });
    // 2 S:S: diagonals 1, -1, 0; off them -1, and in 3-D 2.5 and 2.75.
    const double square = dimension == 2 ? 2 * (2 + 2 * 1) : 2 * (2 + 2 * (1 + 2.5 * 2.5 + 2.75 * 2.75));
    const double expected = std::pow(0.2 * 0.01, 2) * std::sqrt(square);
    for (std::size_t i = 0; i < sheared.particles.water; ++i)
      EXPECT_NEAR(sheared.viscosity[i], expected, 1e-9 * expected) << dimension << "-D, particle " << i;
  }
}

TEST(Turbulence, KeepsMomentumAndTakesEnergy) {
  for (const int dimension : {2, 3}) {
    const Sheared sheared(dimension, [](const double* x) {
      return Vec3d{std::sin(60 * x[1]), std::cos(50 * x[0]) + x[2], 0};
    });
    double local[5] = {}, sums[5];  // momentum, its terms' size, power
    for (std::size_t i = 0; i < sheared.particles.water; ++i) {
      for (int c = 0; c < 3; ++c) {
        local[c] += sheared.acceleration[i][c];
        local[3] += std::abs(sheared.acceleration[i][c]);
        local[4] += sheared.acceleration[i][c] * sheared.particles.record[i].v[c];
      }
    }
    MPI_Allreduce(local, sums, 5, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_GT(sums[3], 0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sums[c], 0, 1e-12 * sums[3]);
    EXPECT_LT(sums[4], 0);
  }
}

/// Load by surface pressure on a fixed body in still water whose level is 1 m above its centre.
coupling::Load buoyancy(int dimension, const coupling::Shape& shape, const coupling::Quaternion& orientation) {
  Scene scene = test::still_tank(dimension, 10);
  scene.thickness = 0.3;
  const Constants constants = constants_of(scene);
  Bodies bodies(constants, {shape}, 1);
  coupling::FluidBody body;
  body.state.orientation = orientation;
  bodies.assign({body});
  std::vector<Traveller> points;
  bodies.collect_points(Decomposition(MPI_COMM_SELF), points);
  for (Traveller& point : points) point.record.p = 1000 * 9.81 * (1 - point.record.x[dimension - 1]);
  Particles particles;
  particles.append(points, {}, {});
  return SurfaceLoads(constants, bodies, 1).partial_loads(particles, bodies).front();
}

TEST(SurfaceLoads, ObeyArchimedes) {
  const coupling::Quaternion upright = coupling::Quaternion::Identity();
  const coupling::Quaternion turned(Eigen::AngleAxisd(0.6, coupling::Vec3::UnitZ()));
  const coupling::Quaternion tumbled(Eigen::AngleAxisd(0.9, coupling::Vec3(1, 2, 3).normalized()));
  const coupling::Shape box{"box", coupling::ShapeKind::box, {0.1, 0.064, 0.05}, 500};
  const coupling::Shape drum{"drum", coupling::ShapeKind::cylinder, {0.05, 0.08, 0}, 500};
  const coupling::Shape ball{"ball", coupling::ShapeKind::sphere, {0.05, 0, 0}, 500};
  const auto expect = [](const coupling::Load& load, const coupling::Vec3& force, double tolerance,
                         double of_torque = 0) {
    EXPECT_NEAR((load.force - force).norm(), 0, tolerance * force.norm());
    EXPECT_NEAR(load.torque.norm(), 0, std::max(tolerance, of_torque) * force.norm() * 0.05);
  };
  const double weight = 1000 * 9.81;
  expect(buoyancy(2, box, upright), {0, weight * 0.1 * 0.064 * 0.3, 0}, 1e-10);
  expect(buoyancy(2, box, turned), {0, weight * 0.1 * 0.064 * 0.3, 0}, 1e-10);
  expect(buoyancy(3, box, tumbled), {0, 0, weight * 0.1 * 0.064 * 0.05}, 1e-10);
  expect(buoyancy(3, drum, tumbled), {0, 0, weight * drum.mass_properties().volume}, 0.05);  // rings of chords
  expect(buoyancy(3, ball, tumbled), {0, 0, weight * ball.mass_properties().volume}, 0.05);
  // Bodies of plane faces, whatever their corners: the force exactly, the torque but for the change of the pressure
  // over a piece.
  const std::vector<Eigen::Vector2d> ell = {{0, 0}, {0.13, 0}, {0.13, 0.05}, {0.04, 0.06}, {0.03, 0.11}, {0, 0.1}};
  coupling::Shape prism = coupling::make_prism(ell, 0.07, 500);
  prism.name = "prism";
  coupling::Shape solid = coupling::make_solid(prism.polyhedron->surface.triangles(), 500);
  solid.name = "solid";
  const double volume = prism.mass_properties().volume;
  expect(buoyancy(2, prism, turned), {0, weight * volume / 0.07 * 0.3, 0}, 1e-10, 1e-3);
  expect(buoyancy(3, prism, tumbled), {0, 0, weight * volume}, 1e-10, 1e-3);
  expect(buoyancy(3, solid, tumbled), {0, 0, weight * volume}, 1e-10, 1e-3);
}

TEST(Bodies, WaterMakesRoomForTheirVolumeAndKeepsItsDistance) {
  const double l0 = 0.005;
  for (const int dimension : {2, 3}) {
    const Constants constants = constants_of(test::still_tank(dimension, 20, l0));
    const coupling::Shape box{"box", coupling::ShapeKind::box, {0.1, 0.064, 0.05}, 500};
    const coupling::Shape ball{"ball", coupling::ShapeKind::sphere, {0.04, 0, 0}, 500};
    for (const coupling::Shape& shape : {box, ball}) {
      if (dimension == 2 && shape.kind == coupling::ShapeKind::sphere) continue;
      Bodies bodies(constants, {shape}, 1);
      coupling::FluidBody body;
      const double section = dimension == 2 ? 0.1 * 0.064 : shape.mass_properties().volume;
      for (const double shift : {0.0, 0.3, 0.5, 0.8}) {
        body.state.position = coupling::Vec3(shift, 0.7 * shift, dimension == 3 ? 0.4 * shift : 0) * l0;
        bodies.assign({body});
        double left_out = 0;
        for (int k = dimension == 3 ? -15 : 0; k < (dimension == 3 ? 15 : 1); ++k) {
          for (int j = -15; j < 15; ++j) {
            for (int i = -15; i < 15; ++i) {
              double x[3] = {(i + 0.5) * l0, (j + 0.5) * l0, dimension == 3 ? (k + 0.5) * l0 : 0};
              if (!bodies.make_room(x)) {
                ++left_out;
              } else {
                EXPECT_LT(bodies.penetration(x), (-0.35 + 1e-4) * l0);
              }
            }
          }
        }
        EXPECT_NEAR(left_out * std::pow(l0, dimension), section, 0.02 * section) << dimension << "-D, shift " << shift;
      }
    }
  }
}

}  // namespace
}  // namespace embacle::mps
