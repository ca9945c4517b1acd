// Who owns which place.
#include "core/decomposition.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/simulation.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

constexpr int sites = 9;  // a side: no number of ranks from 2 to 4 gives whole planes
constexpr double spacing = 1.0 / sites;

std::vector<double> lattice() {
  std::vector<double> positions;
  for (int k = 0; k < sites * sites * sites; ++k) {
    for (const int site : {k % sites, k / sites % sites, k / sites / sites})
      positions.push_back((site + 0.5) * spacing);
  }
  return positions;
}

/// How many of the lattice's points each rank owns; every point must have exactly one owner.
std::vector<int> shares(const Decomposition& decomposition, int ranks) {
  std::vector<int> share(ranks, 0);
  const auto positions = lattice();
  for (std::size_t i = 0; i < positions.size(); i += 3) {
    const int owner = decomposition.owner(&positions[i], 0);
    EXPECT_GE(owner, 0);
    if (owner < 0) continue;
    ++share[owner];
    for (int r = 0; r < ranks; ++r) EXPECT_EQ(decomposition.owns(r, &positions[i]), r == owner);
    for (int c = 0; c < 3; ++c) {  // the box itself misses it by the shear at most
      EXPECT_GE(positions[i + c], decomposition.boxes()[owner].lower[c] - 1e-6);
      EXPECT_LE(positions[i + c], decomposition.boxes()[owner].upper[c] + 1e-6);
    }
  }
  return share;
}

TEST(Decomposition, CutsDivideThePlanesOfALattice) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::vector<double> mine;  // any share of the points
  const auto positions = lattice();
  for (std::size_t i = 0; i < positions.size(); i += 3) {
    if (static_cast<int>(i / 3) % ranks == rank) mine.insert(mine.end(), &positions[i], &positions[i] + 3);
  }
  Periodic periodic;
  periodic.length = {1, 1, 1};
  for (const Periodic& directions : {Periodic{}, periodic}) {
    Decomposition decomposition(MPI_COMM_WORLD, directions, 1e-8);
    decomposition.partition(3, mine, std::vector<float>(mine.size() / 3, 1.0F));
    const auto share = shares(decomposition, ranks);
    EXPECT_LE(*std::max_element(share.begin(), share.end()), std::ceil(1.02 * sites * sites * sites / ranks));
    // The ends of the domain are owned too.
    for (const double end : {0.0, std::nextafter(1.0, 0.0)}) {
      const double corner[3] = {end, end, end};
      EXPECT_GE(decomposition.owner(corner, 0), 0);
    }
  }
}

/// Counted here from the lists: entries, and 8 for every own particle.
double imbalance_of(const Simulation& simulation) {
  const double work = static_cast<double>(simulation.neighbours().pairs() + 8 * simulation.particles().own());
  double sum = 0, largest = 0;
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  MPI_Allreduce(&work, &sum, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  MPI_Allreduce(&work, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  return largest * ranks / sum;
}

TEST(Decomposition, NoStepGoesThroughUnevenLists) {
  const Scene scene = test::collapsing_column(3, 14);
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  (void)simulation.begin_epoch(1);
  double largest = imbalance_of(simulation);
  for (int k = 0; k < 500; ++k) {  // without another epoch
    simulation.window();
    largest = std::max(largest, imbalance_of(simulation));
  }
  EXPECT_LE(largest, scene.numerics.rebalance_imbalance);
  EXPECT_EQ(largest, simulation.extremes().imbalance);
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  if (ranks == 1) return;
  EXPECT_GT(simulation.extremes().imbalance_met, scene.numerics.rebalance_imbalance);  // there was need
}

}  // namespace
}  // namespace embacle::mps
