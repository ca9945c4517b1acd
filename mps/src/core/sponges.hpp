// Places where waves die out. Only scenes that have them come here.
#pragma once

#include <vector>

#include "core/constants.hpp"
#include "core/particles.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// Damping of the water's velocity v towards that of each `[[sponge]]`, u:
///   dv/dt = -(v - u) (s/L)^2 / T,
/// s the way into the zone along its direction, L its length, T its damping time. A step multiplies v - u by the
/// exponential, so that no T is too short. A long wave of speed c that passes, is reflected and comes back has
/// exp(-L/(3 T c)) of its height left; the rise from zero lets it in without a reflection (as in Larsen & Dancy 1983,
/// doi:10.1016/0378-3839(83)90022-4).
class Sponges {
 public:
  Sponges(const Scene& scene, const Constants& constants);

  /// Over a time step [s], of the own water.
  void damp(Particles& particles, double step) const;

  /// T [s] of a sponge: as stated, or the twelfth part of what a long wave in water as deep as the zone is high needs
  /// through it.
  [[nodiscard]] static double damping_time(const Sponge& sponge, double gravity, int upright);

 private:
  struct Zone {
    BoxRegion region;
    int axis;
    double start, per_length;  ///< s/L is (x[axis] - start) per_length
    double rate;               ///< 1/T [1/s]
    Vec3d velocity;
  };
  int dimension_;
  std::vector<Zone> zones_;
};

}  // namespace embacle::mps
