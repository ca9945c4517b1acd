// Neighbour lists against brute force, thin walls included; lattice constants and kernels.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/constants.hpp"
#include "core/neighbours.hpp"
#include "embacle/coupling/types.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

Traveller at(double x, double y, double z, int owner, int side = 0) {
  Traveller traveller;
  traveller.record.x[0] = x;
  traveller.record.x[1] = y;
  traveller.record.x[2] = z;
  traveller.identity.owner = owner;
  traveller.identity.point = side;
  return traveller;
}

/// Own and ghost particles of both kinds at random places.
struct Sample {
  Particles particles;
  std::vector<Traveller> ghost_water;
};

Sample random_particles(int dimension, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<Traveller> groups[4];
  for (int k = 0; k < count; ++k) {
    const int group = static_cast<int>(random() % 4);
    const double z = dimension == 3 ? place(random) : 0.0;
    groups[group].push_back(at(place(random), place(random), z, group % 2 == 0 ? -1 : 0));
  }
  Sample sample;
  sample.particles.assign(groups[0]);
  sample.particles.append(groups[1], groups[2], groups[3]);
  sample.ghost_water = groups[2];
  return sample;
}

std::vector<std::uint32_t> brute_force(const Particles& particles, std::size_t i, bool water, double radius) {
  std::vector<std::uint32_t> result;
  for (std::size_t j = 0; j < particles.all(); ++j) {
    if (j == i || particles.is_water(j) != water) continue;
    double square = 0;
    for (int c = 0; c < 3; ++c) square += std::pow(particles.record[j].x[c] - particles.record[i].x[c], 2);
    if (square < radius * radius) result.push_back(static_cast<std::uint32_t>(j));
  }
  return result;
}

std::vector<std::uint32_t> listed(PackedIndices::Iterator begin, PackedIndices::Iterator end, std::uint32_t sentinel) {
  std::vector<std::uint32_t> result(begin, end);
  std::erase(result, sentinel);
  std::sort(result.begin(), result.end());
  return result;
}

class RandomParticles : public testing::TestWithParam<std::pair<int, double>> {};

TEST_P(RandomParticles, ListsEqualBruteForce) {
  const auto [dimension, radius] = GetParam();
  Scene scene = test::still_tank(dimension, 4);
  const Walls walls(scene, dimension, 3);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto [particles, ghost_water] = random_particles(dimension, 400, seed);
    Neighbours neighbours(dimension, radius);
    neighbours.survey(particles, ghost_water);
    neighbours.build(particles, walls, {});
    for (std::size_t i = 0; i < particles.water; ++i) {
      const NeighbourRange range = neighbours.of_water(i);
      EXPECT_EQ(listed(range.begin, range.middle, particles.sentinel()), brute_force(particles, i, true, radius));
      EXPECT_EQ(listed(range.middle, range.end, particles.sentinel()), brute_force(particles, i, false, radius));
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> wet, expected;
    for (std::size_t k = 0; k < neighbours.wet_points().size(); ++k) {
      const NeighbourRange range = neighbours.of_wet_point(k);
      wet[neighbours.wet_points()[k]] = listed(range.begin, range.end, particles.sentinel());
    }
    for (std::uint32_t b = particles.water; b < particles.own(); ++b) {
      const auto water = brute_force(particles, b, true, radius);
      if (!water.empty()) expected[b] = water;
    }
    EXPECT_EQ(wet, expected);
    EXPECT_EQ(wet.size(), neighbours.wet_points().size());
  }
}

INSTANTIATE_TEST_SUITE_P(DimensionsAndRadii, RandomParticles,
                         testing::Values(std::pair{2, 0.07}, std::pair{2, 0.5}, std::pair{3, 0.12}, std::pair{3, 0.4}));

TEST(Neighbours, AStrayParticleFarAwayDoesNotExhaustMemory) {
  std::vector<Traveller> water{at(0, 0, 0, -1), at(0.01, 0, 0, -1), at(1e6, -1e6, 1e6, -1)};
  Particles particles;
  particles.assign(water);
  Neighbours neighbours(3, 0.02);
  const Scene scene = test::still_tank(3, 4);
  neighbours.survey(particles, {});
  neighbours.build(particles, Walls(scene, 3, 3), {});
  EXPECT_EQ(listed(neighbours.of_water(0).begin, neighbours.of_water(0).middle, particles.sentinel()),
            std::vector<std::uint32_t>{1});
  EXPECT_LT(neighbours.bytes(), 10000U);
}

TEST(Neighbours, MoreParticlesThanAnIndexCountsAreRefused) {
  std::vector<Traveller> water{at(0, 0, 0, -1)};
  Particles particles;
  particles.assign(water);
  particles.ghost_solid = 0xffffff;  // with the one of water, one too many
  Neighbours neighbours(2, 0.02);
  EXPECT_THROW(neighbours.build(particles, Walls(test::still_tank(2, 4), 2, 3), {}), coupling::InputError);
}

TEST(Neighbours, AThinWallHidesTheOtherSide) {
  Scene scene = test::still_tank(2, 10);
  Wall gate;
  gate.name = "gate";
  gate.region = {{0.10, 0.0, 0}, {0.11, 0.2, 0}};
  scene.walls = {gate};
  const Walls walls(scene, 2, 3);
  std::vector<Traveller> solid;
  for (const auto& point : walls.points(0)) solid.push_back(at(point.x[0], point.x[1], 0, 0, point.side));
  // Left and right of the gate, and two below its lower edge that see each other.
  const std::vector<Traveller> water{at(0.095, 0.1, 0, -1), at(0.115, 0.1, 0, -1), at(0.095, -0.03, 0, -1),
                                     at(0.115, -0.03, 0, -1)};
  Particles particles;
  particles.assign(water);
  particles.append(solid, {}, {});
  Neighbours neighbours(2, 0.031);
  neighbours.survey(particles, {});
  neighbours.build(particles, walls, walls.thin_walls(0));
  const auto of = [&](std::size_t i) {
    return listed(neighbours.of_water(i).begin, neighbours.of_water(i).middle, particles.sentinel());
  };
  EXPECT_TRUE(of(0).empty());
  EXPECT_TRUE(of(1).empty());
  EXPECT_EQ(of(2), std::vector<std::uint32_t>{3});
  // Each side sees three layers of its own, none of the other side's.
  for (const auto& [i, sign] : {std::pair{0U, -1}, std::pair{1U, 1}}) {
    std::vector<double> layers;
    const NeighbourRange range = neighbours.of_water(i);
    for (const std::uint32_t j : listed(range.middle, range.end, particles.sentinel())) {
      EXPECT_GT(particles.identity[j].point * sign, 0);
      layers.push_back(std::round(1e4 * particles.record[j].x[0]));
    }
    std::sort(layers.begin(), layers.end());
    layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
    EXPECT_EQ(layers.size(), 3U);
  }
}

TEST(Kernel, LatticeGradientIsExactForALinearField) {
  // (d/n0) SUM r_ij r_ij F is the unit matrix on the lattice by the choice of n0.
  for (const int dimension : {2, 3}) {
    const auto sums = lattice_sums<KernelKind::wendland>(dimension, 0.01, 0.031);
    const Kernel<KernelKind::wendland> kernel{1 / 0.031};
    double xx = 0, xy = 0;
    for (int k = dimension == 3 ? -4 : 0; k <= (dimension == 3 ? 4 : 0); ++k) {
      for (int j = -4; j <= 4; ++j) {
        for (int i = -4; i <= 4; ++i) {
          const double r = 0.01 * std::sqrt(i * i + j * j + k * k);
          if (r == 0) continue;
          xx += 1e-4 * i * i * kernel.gradient_weight(r);
          xy += 1e-4 * i * j * kernel.gradient_weight(r);
        }
      }
    }
    EXPECT_NEAR(dimension * xx / sums.weight, 1, 1e-12);
    EXPECT_NEAR(dimension * xy / sums.weight, 0, 1e-12);
  }
}

TEST(Constants, EquationOfStateAndItsInverseAgree) {
  const Scene scene = test::still_tank(3, 10);
  const Constants c = constants_of(scene);
  for (const double p : {-500.0, 0.0, 1.0, 5e4}) EXPECT_NEAR(pressure_of(density_ratio_of(p, c), c), p, 1e-7);
  EXPECT_NEAR(c.reference_speed, std::sqrt(2 * 9.81 * 0.1), 1e-12);
  EXPECT_NEAR(c.particle_mass, 1e-3, 1e-15);
}

}  // namespace
}  // namespace embacle::mps
