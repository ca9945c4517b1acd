// The kernels one by one, on a sorted, slightly disordered lattice of 200 000 water particles above a wall, on one
// core.
#include <benchmark/benchmark.h>
#include <mpi.h>

#include <cstdio>
#include <map>
#include <memory>
#include <random>

#include "core/corrections.hpp"
#include "core/diagnostics.hpp"
#include "core/displacements.hpp"
#include "core/halo.hpp"
#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "limits.hpp"

namespace embacle::mps::bench {
namespace {

constexpr int across = 58;  // 195 112 water particles
constexpr double l0 = 0.01;

Scene block_of_water(double support) {
  Scene scene;
  scene.file = "benchmark";
  scene.dimension = 3;
  scene.numerics.particle_distance = l0;
  scene.numerics.support = support;
  scene.fluid.gravity = {0, 0, -9.81};
  Water water;
  water.region.upper = {across * l0, across * l0, across * l0};
  scene.water = {water};
  Wall tank;
  tank.kind = Wall::Kind::tank;
  tank.region.upper = water.region.upper;
  scene.walls = {tank};
  scene.domain.lower = {-1, -1, -1};
  scene.domain.upper = {2, 2, 2};
  return scene;
}

/// All that the kernels need, with the lists built.
struct Block {
  Scene scene;
  Constants constants;
  Walls walls;
  Neighbours neighbours;
  Displacements displacements;
  Corrections corrections;
  Halo halo{MPI_COMM_WORLD};
  Particles particles;
  std::vector<Triple> acceleration;
  Reactions reaction;
  double water_pairs = 0, wet_pairs = 0;    ///< listed, padding included
  double water_within = 0, wet_within = 0;  ///< within the support

  explicit Block(double support)
      : scene(block_of_water(support)),
        constants(constants_of(scene)),
        walls(scene, 3, constants.layers),
        neighbours(3, constants.support + constants.skin),
        displacements(constants.support, constants.skin),
        corrections(constants) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> disorder(-0.1 * l0, 0.1 * l0);
    std::vector<Traveller> water, solid;
    for (int k = -constants.layers; k < across; ++k) {
      for (int j = 0; j < across; ++j) {
        for (int i = 0; i < across; ++i) {
          Traveller point;
          const int site[3] = {i, j, k};
          for (int c = 0; c < 3; ++c) {
            point.record.x[c] = (site[c] + 0.5) * l0 + (k >= 0 ? disorder(random) : 0.0);
            point.record.v[c] = k >= 0 ? disorder(random) : 0.0;
          }
          point.record.p = 1000 * 9.81 * (across - k) * l0;
          point.record.s = density_ratio_of(point.record.p, constants);
          point.identity.id = static_cast<std::int64_t>(k >= 0 ? water.size() : solid.size());
          point.identity.owner = k >= 0 ? -1 : 0;
          (k >= 0 ? water : solid).push_back(point);
        }
      }
    }
    particles.assign(water, neighbours.cell_order(water));
    neighbours.survey(particles, {});
    particles.append(solid, {}, {});
    neighbours.build(particles, walls, {});
    displacements.remember(particles);
    corrections.update(particles, neighbours, halo, 1.0);
    for (std::size_t i = 0; i < particles.water; ++i) {
      const NeighbourRange range = neighbours.of_water(i);
      water_pairs += static_cast<double>(range.end - range.begin);
    }
    wet_pairs = static_cast<double>(neighbours.pairs()) - water_pairs;
    const auto within = [&](std::size_t i, const NeighbourRange& range) {
      double found = 0;
      for (auto k = range.begin; k < range.end; ++k) {
        double square = 0;
        for (int c = 0; c < 3; ++c) square += std::pow(particles.record[*k].x[c] - particles.record[i].x[c], 2);
        found += square < constants.support * constants.support ? 1 : 0;
      }
      return found;
    };
    for (std::size_t i = 0; i < particles.water; ++i) water_within += within(i, neighbours.of_water(i));
    for (std::size_t k = 0; k < neighbours.wet_points().size(); ++k) {
      wet_within += within(neighbours.wet_points()[k], neighbours.of_wet_point(k));
    }
  }
};

Block& block(double support) {
  static std::map<double, std::unique_ptr<Block>> blocks;
  auto& found = blocks[support];
  if (!found) found = std::make_unique<Block>(support);
  return *found;
}

double peak = 0, bandwidth = 0;

/// Work of one call of a kernel.
struct Work {
  double particles, listed, within;
  double flops_per_pair = 0;  ///< square root and division count as one each
  double bytes = 0;           ///< to and from memory at least: each record and list once
};

template <class Kernel>
void run(benchmark::State& state, const Work& work, const Kernel& kernel) {
  for (auto _ : state) kernel();
  using benchmark::Counter;
  const auto rate = [&](double amount) { return Counter(amount, Counter::kIsIterationInvariantRate); };
  state.counters["particles/s"] = rate(work.particles);
  if (work.listed > 0) state.counters["listed/s"] = rate(work.listed);
  if (work.within > 0) state.counters["within/s"] = rate(work.within);
  if (work.flops_per_pair > 0) {
    state.counters["flop/pair"] = work.flops_per_pair;
    state.counters["of_peak"] = rate(work.flops_per_pair * work.listed / peak);
  }
  if (work.bytes > 0) {
    state.counters["B/particle"] = work.bytes / work.particles;
    state.counters["of_triad"] = rate(work.bytes / bandwidth);
  }
}

double support_of(const benchmark::State& state) { return 0.1 * static_cast<double>(state.range(0)); }

/// Work of a sweep over the water, which reads and writes `bytes` a particle beside the lists.
Work water_sweep(const Block& b, double flops_per_pair, double bytes) {
  const auto n = static_cast<double>(b.particles.water);
  return {n, b.water_pairs, b.water_within, flops_per_pair, n * bytes + PackedIndices::width * b.water_pairs};
}

void density(benchmark::State& state) {
  Block& b = block(support_of(state));
  const Particles start = b.particles;  // it advances the water
  run(state, water_sweep(b, 43, 64 + 64 + 8), [&] { advance_density(b.particles, b.neighbours, b.constants); });
  b.particles = start;
}

void force(benchmark::State& state) {
  Block& b = block(support_of(state));
  run(state, water_sweep(b, 37, 64 + 8 + 24),
      [&] { accelerate(b.particles, b.neighbours, b.constants, b.acceleration, b.reaction); });
}

void walls(benchmark::State& state) {
  Block& b = block(support_of(state));
  run(state, {static_cast<double>(b.neighbours.wet_points().size()), b.wet_pairs, b.wet_within, 23},
      [&] { extrapolate_pressure(b.particles, b.neighbours, b.constants, {}); });
}

void search(benchmark::State& state) {
  Block& b = block(support_of(state));
  Neighbours neighbours(3, b.constants.support + b.constants.skin);
  run(state, {static_cast<double>(b.particles.own()), b.water_pairs + b.wet_pairs, b.water_within + b.wet_within}, [&] {
    neighbours.survey(b.particles, {});
    neighbours.build(b.particles, b.walls, {});
  });
}

void displacements(benchmark::State& state) {
  Block& b = block(support_of(state));
  const auto n = static_cast<double>(b.particles.all());
  run(state, {n, 0, 0, 0, n * (64 + 16)}, [&] { benchmark::DoNotOptimize(b.displacements.lists_hold(b.particles)); });
}

void corrections_update(benchmark::State& state) {
  Block& b = block(support_of(state));
  run(state, {static_cast<double>(b.particles.water), b.water_pairs, b.water_within},
      [&] { b.corrections.update(b.particles, b.neighbours, b.halo, 1.0); });
}

void corrections_density(benchmark::State& state) {
  Block& b = block(support_of(state));
  const Particles start = b.particles;
  run(state, {static_cast<double>(b.particles.water), b.water_pairs, b.water_within},
      [&] { b.corrections.advance_density(b.particles, b.neighbours); });
  b.particles = start;
}

void corrections_force(benchmark::State& state) {
  Block& b = block(support_of(state));
  run(state, {static_cast<double>(b.particles.water), b.water_pairs, b.water_within},
      [&] { b.corrections.accelerate(b.particles, b.neighbours, b.acceleration, b.reaction); });
}

}  // namespace
}  // namespace embacle::mps::bench

int main(int argc, char** argv) {
  using namespace embacle::mps::bench;
  MPI_Init(&argc, &argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  peak = peak_flops();
  bandwidth = triad_bandwidth();
  benchmark::AddCustomContext("peak_gflops", std::to_string(1e-9 * peak));
  benchmark::AddCustomContext("triad_gigabytes_per_second", std::to_string(1e-9 * bandwidth));
  const std::pair<const char*, void (*)(benchmark::State&)> kernels[] = {{"density", density},
                                                                         {"force", force},
                                                                         {"walls", walls},
                                                                         {"search", search},
                                                                         {"displacements", displacements},
                                                                         {"corrections_update", corrections_update},
                                                                         {"corrections_density", corrections_density},
                                                                         {"corrections_force", corrections_force}};
  for (const auto& [name, kernel] : kernels) {
    benchmark::RegisterBenchmark(name, kernel)
        ->Arg(21)
        ->Arg(31)
        ->ArgName("support_in_l0/10")
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  MPI_Finalize();
  return 0;
}
