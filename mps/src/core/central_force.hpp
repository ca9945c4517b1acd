// A force on the water towards a centre, in proportion to the distance. Only scenes that have one come here.
#pragma once

#include <vector>

#include "core/operators.hpp"

namespace embacle::mps {

/// The acceleration -k (x - c) [m/s^2], k = fluid.central_force, as in the drop of Monaghan & Rafiee (2013,
/// doi:10.1002/fld.3671).
class CentralForce {
 public:
  explicit CentralForce(const Constants& constants) : constants_(constants) {}

  /// Takes the hydrostatic part of this force out of the density diffusion, which advance_density() has left in: ds/dt
  /// loses D SUM s^-6 g(m).r_ij/c0^2 F r^2, with the force at the middle m of the pair. The difference of this force's
  /// potential between two places is exactly that product, so water at rest under it has no diffusion.
  void correct_density(Particles& particles, const Neighbours& neighbours);

  /// The acceleration at a place.
  [[nodiscard]] Triple at(const double* x) const {
    Triple result{};
    for (int d = 0; d < constants_.dimension; ++d)
      result[d] = -constants_.central_force * (x[d] - constants_.centre[d]);
    return result;
  }
  /// Adds it to the acceleration of the own water.
  void accelerate(const Particles& particles, std::vector<Triple>& acceleration) const;
  /// Subtracts it from that of the wet solid points, so that extrapolate_pressure() has it beside gravity.
  void relieve_points(const Particles& particles, const Neighbours& neighbours,
                      std::vector<Triple>& acceleration) const;

 private:
  const Constants& constants_;
  std::vector<double> change_;  ///< of s in this step
};

}  // namespace embacle::mps
