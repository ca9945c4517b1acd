// Corrected operators and shifting: exact for linear fields, pair forces opposite, the free surface found, particles
// evened out, the same on any number of ranks.
#include "core/corrections.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include <cmath>
#include <functional>

#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::result_of;
using test::run;

constexpr double l0 = 0.01;

TEST(PlainShifting, ShiftsAndLeavesTheOperatorsAlone) {
  // The density rate is that of the plain operators at the same places (whose geometry is that of mid-step: without
  // motion the same), the shift that of the corrected ones.
  Scene scene = test::vortices(2, 12);
  scene.numerics.density_diffusion = 0.1;  // the same with and without shifting
  for (WaterTable::Row& row : scene.water.front().table.rows) row.velocity = {};
  scene.water.front().table.has_pressure = true;
  for (WaterTable::Row& row : scene.water.front().table.rows) row.pressure = 100 * std::sin(50 * row.position[0]);
  const auto advanced = [&](Regularisation regularisation) {
    scene.numerics.regularisation = regularisation;
    Simulation simulation(scene, MPI_COMM_SELF, nullptr);
    (void)simulation.begin_epoch(1);
    Particles particles = simulation.particles();
    Halo halo = simulation.halo();
    std::vector<Triple> acceleration;
    Reactions reaction;
    if (!shifts(regularisation)) {
      advance_density(particles, simulation.neighbours(), simulation.constants());
      accelerate(particles, simulation.neighbours(), simulation.constants(), acceleration, reaction);
    } else {
      Corrections corrections(simulation.constants());
      corrections.update(particles, simulation.neighbours(), halo, 1);
      corrections.advance_density(particles, simulation.neighbours());
      corrections.accelerate(particles, simulation.neighbours(), acceleration, reaction);
    }
    std::map<std::int64_t, Triple> result;  // density, acceleration
    for (std::size_t i = 0; i < particles.water; ++i)
      result[particles.identity[i].id] = {particles.record[i].s, acceleration[i][0], acceleration[i][1]};
    return result;
  };
  const auto plain = advanced(Regularisation::none), shifted = advanced(Regularisation::plain_shifting),
             corrected = advanced(Regularisation::shifting);
  double difference = 0, size = 0;
  for (const auto& [id, values] : plain) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shifted.at(id)[c], values[c], 1e-9 * (c == 0 ? 1 : 10)) << id;
    difference += std::abs(corrected.at(id)[1] - values[1]);
    size += std::abs(values[1]);
  }
  EXPECT_GT(difference, 0.01 * size);  // the corrected operators are others
}

Scene with_shifting(Scene scene) {
  scene.numerics.regularisation = Regularisation::shifting;
  return scene;
}

/// A square or cube of n particles each way off the lattice by up to `disorder` l0, without walls, that moves by
/// `field`.
Scene block(int dimension, int n, double disorder, const std::function<Vec3d(const Vec3d&)>& field) {
  Scene scene = with_shifting(test::still_tank(dimension, n, l0));
  scene.walls.clear();
  scene.fluid.gravity = {};
  scene.numerics.reference_speed = 1;
  scene.numerics.density_diffusion = 0;
  Water& water = scene.water.front();
  water.kind = Water::Kind::table;
  water.table.has_velocity = true;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> off(-disorder * l0, disorder * l0);
  for (int k = 0; k < (dimension == 3 ? n : 1); ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        Vec3d x{(i + 0.5) * l0 + off(random), (j + 0.5) * l0 + off(random), 0};
        if (dimension == 3) x[2] = (k + 0.5) * l0 + off(random);
        water.table.rows.push_back({x, field(x)});
      }
    }
  }
  return scene;
}

/// A simulation after its first search, and the corrections for where its particles are.
struct State {
  explicit State(const Scene& scene) : simulation(scene, MPI_COMM_WORLD, nullptr), corrections(simulation.constants()) {
    (void)simulation.begin_epoch(1);
    particles = simulation.particles();
    Halo halo = simulation.halo();
    corrections.update(particles, simulation.neighbours(), halo, scene.numerics.reference_speed);
  }
  [[nodiscard]] bool interior(std::size_t i) const { return corrections.of_particles()[i].interior > 0; }

  Simulation simulation;
  Particles particles;
  Corrections corrections;
};

/// Divergence at `x` by the corrected sum over all rows of a table, without lists, packs or ranks.
double divergence(const Scene& scene, const Constants& c, const double* x, const Vec3d& v) {
  const auto sum = [&]<KernelKind K>(const Kernel<K>& kernel) {
    double m[3][3] = {}, flux[3][3] = {};  // SUM F r r, SUM F (v_j - v_i) r
    if (c.dimension == 2) m[2][2] = 1;
    for (const WaterTable::Row& row : scene.water.front().table.rows) {
      const double r[3] = {row.position[0] - x[0], row.position[1] - x[1], row.position[2] - x[2]};
      const double distance = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
      if (distance < 1e-9) continue;
      const double f = kernel.gradient_weight(distance);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          m[a][b] += f * r[a] * r[b];
          flux[a][b] += f * (row.velocity[a] - v[a]) * r[b];
        }
      }
    }
    const auto minor = [&](int a, int b) {
      const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
      return m[a1][b1] * m[a2][b2] - m[a1][b2] * m[a2][b1];
    };
    const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    double result = 0;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) result += flux[a][b] * minor(a, b) / determinant;
    }
    return result;
  };
  return c.kernel == KernelKind::wendland ? sum(Kernel<KernelKind::wendland>{1 / c.support})
                                          : sum(Kernel<KernelKind::rational>{1 / c.support});
}

/// Spread (standard deviation over mean) of SUM W of the water of all ranks.
double spread_of_weights(const Simulation& simulation) {
  const Constants& c = simulation.constants();
  const Kernel<KernelKind::wendland> kernel{1 / c.support};
  double sums[3] = {};
  for (std::size_t i = 0; i < simulation.particles().water; ++i) {
    const NeighbourRange range = simulation.neighbours().of_water(i);
    double weight = 0;
    for (auto k = range.begin; k < range.end; ++k) {
      double square = 0;
      for (int d = 0; d < 3; ++d) {
        square += std::pow(simulation.particles().record[*k].x[d] - simulation.particles().record[i].x[d], 2);
      }
      weight += square * kernel.gradient_weight(std::sqrt(square));
    }
    sums[0] += 1;
    sums[1] += weight;
    sums[2] += weight * weight;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return std::sqrt(std::max(0.0, sums[2] * sums[0] / (sums[1] * sums[1]) - 1));
}

TEST(Corrections, ALinearFieldHasItsExactDivergenceInADisorderedInterior) {
  for (const int dimension : {2, 3}) {
    for (const KernelKind kernel : {KernelKind::wendland, KernelKind::rational}) {
      const double z = dimension == 3 ? 1 : 0;
      Scene scene = block(dimension, dimension == 3 ? 14 : 20, 0.15, [&](const Vec3d& x) {
        return Vec3d{0.3 + 0.7 * x[0] - 2 * x[1], 1.5 * x[0] + 0.4 * x[1] + z * x[2], z * (3 * x[0] - 0.6 * x[2])};
      });
      scene.numerics.kernel = kernel;
      scene.numerics.cfl = 0.01;
      State state(scene);
      Particles after = state.particles;
      state.corrections.advance_density(after, state.simulation.neighbours());
      const double step = state.simulation.constants().step;
      const double rounding = 4 * std::numeric_limits<double>::epsilon() / step;  // of a density near 1
      const double exact = 1.1 - 0.6 * z;
      int interior = 0;
      for (std::size_t i = 0; i < state.particles.water; ++i) {
        if (!state.interior(i)) continue;
        ++interior;
        const Record& me = state.particles.record[i];
        const double rate = (after.record[i].s - me.s) / step;
        EXPECT_NEAR(-rate, exact, rounding);
        EXPECT_NEAR(divergence(scene, state.simulation.constants(), me.x, {me.v[0], me.v[1], me.v[2]}), exact, 1e-12);
      }
      MPI_Allreduce(MPI_IN_PLACE, &interior, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
      EXPECT_GE(interior, 60);
    }
  }
}

TEST(Corrections, AUniformShearFeelsNoViscosityInADisorderedInterior) {
  for (const int dimension : {2, 3}) {
    const double z = dimension == 3 ? 1 : 0;
    Scene scene = block(dimension, dimension == 3 ? 14 : 20, 0.15, [&](const Vec3d& x) {
      return Vec3d{0.3 + 0.7 * x[0] - 2 * x[1], 1.5 * x[0] + 0.4 * x[1] + z * x[2], z * (3 * x[0] - 0.6 * x[2])};
    });
    scene.fluid.kinematic_viscosity = 1e-2;
    scene.fluid.gravity = {};
    scene.numerics.shifting = 0;
    scene.numerics.collision_distance = scene.numerics.artificial_viscosity = 0;  // both act beside the surface
    State state(scene);
    std::vector<Triple> acceleration;
    Reactions reaction;
    state.corrections.accelerate(state.particles, state.simulation.neighbours(), acceleration, reaction);
    const double scale = scene.fluid.kinematic_viscosity * 3 / l0;  // of the term for one pair
    int interior = 0;
    for (std::size_t i = 0; i < state.particles.water; ++i) {
      if (!state.interior(i)) continue;
      ++interior;
      for (int c = 0; c < dimension; ++c) EXPECT_NEAR(acceleration[i][c], 0, 1e-12 * scale);
    }
    MPI_Allreduce(MPI_IN_PLACE, &interior, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_GE(interior, 60);
  }
}

TEST(Corrections, PairForcesAreOppositeInTheInteriorWithoutTension) {
  for (const int dimension : {2, 3}) {
    Scene scene = with_shifting(test::vortices(dimension, dimension == 3 ? 10 : 24));
    scene.numerics.shifting = 0;  // what is carried along is no pair force
    scene.water.front().table.has_pressure = true;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> pressure(0, 1000);
    for (WaterTable::Row& row : scene.water.front().table.rows) row.pressure = pressure(random);
    State state(scene);
    std::vector<Triple> acceleration;
    Reactions reaction;
    state.corrections.accelerate(state.particles, state.simulation.neighbours(), acceleration, reaction);
    double sums[4] = {};
    for (const Triple& a : acceleration) {
      for (int c = 0; c < 3; ++c) sums[c] += a[c];
      sums[3] += std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_GT(sums[3], 0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sums[c], 0, 1e-13 * sums[3]);
  }
}

TEST(Corrections, TheFreeSurfaceOfALatticeIsItsOutermostLayer) {
  for (const int dimension : {2, 3}) {
    for (const double support : {2.1, 3.1}) {
      const int n = 12;
      Scene scene = block(dimension, n, 0, [](const Vec3d&) { return Vec3d{}; });
      scene.numerics.support = support;
      const State state(scene);
      for (std::size_t i = 0; i < state.particles.water; ++i) {
        int depth = n;  // layers above this one
        for (int c = 0; c < dimension; ++c) {
          const int layer = static_cast<int>(std::floor(state.particles.record[i].x[c] / l0));
          depth = std::min({depth, layer, n - 1 - layer});
        }
        EXPECT_EQ(state.interior(i), depth > support) << dimension << "-D, " << support << " l0, layer " << depth;
      }
    }
  }
}

TEST(Corrections, ShiftingEvensOutADisorderedBox) {
  for (const int dimension : {2, 3}) {
    const auto spread_after = [&](int windows, double shifting) {
      Scene scene = with_shifting(test::vortices(dimension, dimension == 3 ? 10 : 24));
      scene.numerics.shifting = shifting;
      Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
      run(simulation, windows);
      return spread_of_weights(simulation);
    };
    const double before = spread_after(1, 0), without = spread_after(100, 0), with = spread_after(100, 1);
    EXPECT_LT(with, before);
    EXPECT_LT(with, 0.7 * without);
  }
}

TEST(Corrections, StillWaterKeepsItsSurface) {
  const int n = 20;
  const Scene scene = with_shifting(test::still_tank(2, n));
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run(simulation, 1000);
  Gauge gauge;
  for (const double x : {0.055, 0.1, 0.145}) {
    gauge.position = {x, 0, 0};
    EXPECT_NEAR(water_level(simulation, scene, gauge), n * l0, 0.05 * l0);
  }
  EXPECT_LT(measure(simulation, scene).energy.kinetic, 1e-4 * 40 * 9.81 * n * l0);
}

TEST(Corrections, AnyNumberOfRanksGivesTheSame) {
  for (const int dimension : {2, 3}) {
    const int n = dimension == 3 ? 10 : 24;
    for (const Scene& scene :
         {with_shifting(test::vortices(dimension, n)), with_shifting(test::collapsing_column(dimension, n))}) {
      const test::Result parallel = result_of(scene, MPI_COMM_WORLD, 100);
      const test::Result alone = result_of(scene, MPI_COMM_SELF, 100);
      const Energies &a = parallel.state.energy, &b = alone.state.energy;
      EXPECT_GT(b.kinetic, 0);
      EXPECT_NEAR(a.kinetic, b.kinetic, 1e-10 * b.kinetic);
      EXPECT_NEAR(a.elastic, b.elastic, 1e-10 * b.kinetic);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(parallel.centre[c], alone.centre[c], 1e-10 * n * l0);
    }
  }
}

}  // namespace
}  // namespace embacle::mps
