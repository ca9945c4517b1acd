// How far particles have moved since the neighbour lists were built, and whether the lists still hold.
#pragma once

#include <cstdint>
#include <vector>

#include "core/particles.hpp"

namespace embacle::mps {

/// Lists hold all pairs within support + skin at the time of the build. A pair can only come within the support
/// unlisted if its distance shrinks by more than the skin. Two bounds exclude that:
///   - nothing has moved by more than the skin, so that only pairs within support + 2 skin need a look;
///   - within blocks of that size and their neighbours, the displacements differ by no more than the skin.
/// Water that moves together, as in a jet, and water along walls thus keeps its lists twice as long as under the usual
/// bound of half a skin.
class Displacements {
 public:
  /// Distance [m] within which particles of other ranks must be known as ghosts.
  [[nodiscard]] static double reach(double support, double skin) { return support + 2 * skin; }

  Displacements(double support, double skin) : skin_(skin), block_(reach(support, skin)) {}

  /// Remembers where all particles are, ghosts included.
  void remember(const Particles& particles);
  /// Whether the lists of the own particles still hold.
  [[nodiscard]] bool lists_hold(const Particles& particles);
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Span {
    float low[3], high[3];
  };
  [[nodiscard]] std::size_t block_of(const std::array<float, 3>& place) const;
  void widen_along(int axis);

  double skin_, block_;
  double origin_[3] = {0, 0, 0};
  int blocks_[3] = {1, 1, 1};
  float per_block_ = 0;                      ///< blocks a length [1/m]
  float limit_ = 0;                          ///< the skin, less what single precision can lose [m]
  std::vector<std::array<float, 3>> place_;  ///< relative to the origin
  std::vector<Span> span_, widened_;         ///< of the displacements in each block
};

}  // namespace embacle::mps
