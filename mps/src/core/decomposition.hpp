// Which rank owns which part of space: recursive coordinate bisection by Zoltan.
#pragma once

#include <mpi.h>

#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::mps {

using coupling::Box;

/// Splits space into one box a rank such that each holds about the same weight.
class Decomposition {
 public:
  explicit Decomposition(MPI_Comm comm);

  /// Collective. `positions`: 3 per point [m]; `weights`: one per point. Afterwards every rank knows every box;
  /// together they tile space (outer faces at +-infinity).
  void partition(int dimension, const std::vector<double>& positions, const std::vector<float>& weights);

  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }
  [[nodiscard]] const Box& own() const { return boxes_[rank_]; }
  /// Rank that owns a place; tries `guess` first.
  [[nodiscard]] int owner(const double* x, int guess) const;
  /// Other ranks whose box lies within `reach` [m] of this rank's, ascending.
  [[nodiscard]] std::vector<int> neighbours(double reach) const;

 private:
  MPI_Comm comm_;
  int rank_ = 0;
  int size_ = 1;
  std::vector<Box> boxes_;
};

/// Whether two boxes come within `reach` of each other.
[[nodiscard]] bool within_reach(const Box& a, const Box& b, double reach);

}  // namespace embacle::mps
