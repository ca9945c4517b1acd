// Friction of the water on walls that say whether it slips.
#pragma once

#include <vector>

#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "core/walls.hpp"

namespace embacle::mps {

/// The viscous term of solids in a scene whose walls say whether the water slips, or have a velocity of their surface
/// (Constants::wall_friction); elsewhere accelerate() has it.
///
/// Without slip the velocity of the water is continued into the wall so that it is that of the wall on its surface,
/// linearly along the normal (Morris et al. 1997, doi:10.1006/jcph.1997.5776): a pair contributes
///   nu (2d/(lambda n0)) (1 + d_b/d_i) (v_b - v_i) F r^2
/// with the distances d_b, d_i of wall point and water from the surface. Linear profiles are exact on any lattice.
/// Walls that do not say, and bodies, have the factor 2 (the velocity of the water is mirrored point by point).
class Friction {
 public:
  Friction(const Scene& scene, const Constants& constants, const Walls& walls);

  /// Adds to the acceleration of the own water, and the exact opposite forces to `reaction` (slots as in accelerate()).
  /// `time` is that of the positions. Does nothing unless the scene needs it.
  void apply(const Particles& particles, const Neighbours& neighbours, double time, std::vector<Triple>& acceleration,
             Reactions& reaction) const;

 private:
  enum class Contact { slips, mirrored, sticks };
  template <KernelKind K>
  void add(const Particles& particles, const Neighbours& neighbours, double time, std::vector<Triple>& acceleration,
           Reactions& reaction) const;

  const Constants& constants_;
  const Walls& walls_;
  std::vector<Contact> contact_;  ///< of each wall
};

}  // namespace embacle::mps
