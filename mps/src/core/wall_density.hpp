// Pressure of walls from a density of their own, as an alternative to its extrapolation from the water.
#pragma once

#include <cstdint>
#include <vector>

#include "core/constants.hpp"
#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "core/particles.hpp"

namespace embacle::mps {

/// `wall_pressure = "continuity"` (thesis section 5.1.4 with eq 5.16 for the solid points): each wall point has
///   ds/dt = -(d/n0) SUM (v_j - v_b).r_bj F over water,  s >= 1,
/// with the geometry of mid-step as in advance_density(), and its pressure by the equation of state. Without water
/// within the support it is at rest density. Points that are wet at the start begin with the extrapolated pressure;
/// those that water reaches later begin at rest.
///
/// The densities are among the particles while lists hold, and here, in the order of the stored wall points, between.
class WallDensity {
 public:
  explicit WallDensity(const Constants& constants) : constants_(constants) {}

  /// Takes over the stored wall points of this rank, with their densities.
  void adopt(const std::vector<Traveller>& points);
  /// n/n0 of stored wall point `k`.
  [[nodiscard]] double of(std::size_t k) const { return stored_[k]; }
  /// Called for all stored points in their order when lists are built: those near water go among the particles, where
  /// they are the first own solid points. Returns the density to go with.
  double pass(std::size_t k, bool near_water);
  /// Takes the densities back from the particles.
  void keep(const Particles& particles);

  /// Density and pressure of the wet points after a step, once the water has its own.
  void advance(Particles& particles, const Neighbours& neighbours);

  [[nodiscard]] bool started() const { return started_; }
  /// Continues from stored densities.
  void restart(std::vector<double> stored, bool started);
  [[nodiscard]] std::size_t bytes() const {
    return stored_.capacity() * sizeof(double) + among_.capacity() * sizeof(std::uint32_t);
  }

 private:
  template <int D, KernelKind K>
  void rates(Particles& particles, const Neighbours& neighbours) const;

  const Constants& constants_;
  std::vector<double> stored_;        ///< n/n0 of each stored wall point
  std::vector<std::uint32_t> among_;  ///< stored points that are among the particles, in their order
  bool started_ = false;
};

}  // namespace embacle::mps
