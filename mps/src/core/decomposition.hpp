// Which rank owns which part of space: recursive coordinate bisection by Zoltan.
#pragma once

#include <mpi.h>

#include <utility>
#include <vector>

#include "core/periodic.hpp"
#include "embacle/coupling/types.hpp"

namespace embacle::mps {

using coupling::Box;

/// A rank whose box lies near that of this rank, or an image of one, in periodic directions also of this rank itself.
struct Nearby {
  int rank = 0;
  std::array<int, 3> image{};  ///< periods by which what this rank has is displaced to stand beside that box
};

/// Splits space into one box a rank such that each holds about the same weight.
///
/// A cut could not divide a plane of an initial lattice, whose points all have the same coordinate. Therefore places
/// are compared with the boxes after a shear so small that it only orders the points of such a plane.
class Decomposition {
 public:
  /// `tie_shear`: of each coordinate by the two others, a displacement per length; the boxes hold up to that times the
  /// extent of the scene.
  explicit Decomposition(MPI_Comm comm, const Periodic& periodic = {}, double tie_shear = 0);

  /// Collective. `positions`: 3 per point [m]; `weights`: one per point. Afterwards every rank knows every box;
  /// together they tile space (outer faces at +-infinity, or at the ends of the domain where it is periodic).
  void partition(int dimension, const std::vector<double>& positions, const std::vector<float>& weights);

  /// Takes boxes over that an earlier partition into as many has made.
  void adopt(std::vector<Box> boxes) { boxes_ = std::move(boxes); }

  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }
  [[nodiscard]] const Box& own() const { return boxes_[rank_]; }
  /// Whether a rank owns a place (wrapped, in periodic directions): exactly one does.
  [[nodiscard]] bool owns(int rank, const double* x) const;
  [[nodiscard]] bool owns(const double* x) const { return owns(rank_, x); }
  /// Rank that owns a place; tries `guess` first.
  [[nodiscard]] int owner(const double* x, int guess) const;
  /// Other ranks whose box, or an image of it, lies within `reach` [m] of this rank's, ascending.
  [[nodiscard]] std::vector<int> neighbours(double reach) const;
  /// Boxes and images of boxes within `reach`, by ascending rank; without periodic directions just the neighbours. If
  /// (rank b, image) is near rank a, then (rank a, -image) is near rank b.
  [[nodiscard]] std::vector<Nearby> nearby(double reach) const;
  [[nodiscard]] const Periodic& periodic() const { return periodic_; }

 private:
  void set_box(int rank, const coupling::Vec3& lower, const coupling::Vec3& upper);
  [[nodiscard]] double sheared(const double* x, int axis) const;

  MPI_Comm comm_;
  int rank_ = 0;
  int size_ = 1;
  Periodic periodic_;
  double tie_shear_;
  std::vector<Box> boxes_;
};

/// Whether two boxes come within `reach` of each other.
[[nodiscard]] bool within_reach(const Box& a, const Box& b, double reach);

}  // namespace embacle::mps
