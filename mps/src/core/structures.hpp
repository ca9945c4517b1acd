// Force and torque of the water on walls that the scene asks them of.
#pragma once

#include <mpi.h>

#include <vector>

#include "core/operators.hpp"
#include "core/particles.hpp"
#include "embacle/coupling/types.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// Impulses on walls with `forces = true`: the exact opposite of what the water felt, by the pairs and by the guard.
class Structures {
 public:
  explicit Structures(const Scene& scene);

  /// Adds a step [s]: `reaction` as from accelerate(), on the points; `guard`: on each wall.
  void add(const Particles& particles, const std::vector<Triple>& reaction, const std::vector<coupling::Load>& guard,
           double step);
  /// Mean force [N] and torque about the origin [N m] on each recorded wall, in the order of the scene, since the last
  /// call; zero if no step was made. Collective; the sums are right on rank 0.
  [[nodiscard]] std::vector<coupling::Load> take_means(MPI_Comm comm);

 private:
  std::vector<int> slot_;                 ///< of each wall, -1: not recorded
  std::vector<coupling::Load> impulses_;  ///< of each slot [N s, N m s]
  double time_ = 0;                       ///< in which they came about [s]
};

}  // namespace embacle::mps
