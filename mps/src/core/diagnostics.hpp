// What is measured on the running water: energies, momentum, volume, gauges. All functions are collective, and need the
// neighbour lists of a running simulation (after its first epoch has begun).
#pragma once

#include <array>

#include "core/simulation.hpp"

namespace embacle::mps {

struct Energies {
  double kinetic = 0;  ///< [J]
  /// Of the gravity that pressure can balance, zero at the origin, and of the central force, zero at its centre [J].
  double potential = 0;
  double elastic = 0;  ///< of compression [J]
  /// Taken up by the pressure of solid points since the start, and held by the guard's springs; in audited runs [J].
  double in_solids = 0;
  double bodies = 0;  ///< of the bodies: kinetic, and potential in gravity [J]
  double work = 0;    ///< done on them since the start by all but water and gravity, and brought by new ones [J]
  /// Of the water.
  [[nodiscard]] double total() const { return kinetic + potential + elastic + in_solids; }
  /// What may fall but never grow while no wall moves.
  [[nodiscard]] double balance() const { return total() + bodies - work; }
};

struct WaterState {
  std::int64_t particles = 0;
  double mass = 0;  ///< [kg]
  Energies energy;
  double kinetic_of_bodies = 0;    ///< [J]
  Triple momentum{};               ///< [N s]
  double volume_ratio = 1;         ///< volume that the interior water occupies over that of the rest lattice, from the
                                   ///< particles' arrangement alone; 1 at the start
  double interior_share = 0;       ///< share of the particles on which volume_ratio rests
  std::int64_t outside_tank = 0;   ///< water particles beyond a closed face of a tank
  std::int64_t inside_bodies = 0;  ///< water particles whose centre lies inside a body
  double deepest_in_body = 0;      ///< [m]
  double farthest_outside_tank = 0;  ///< [m]
  double compressed_share = 0;       ///< share of the particles whose density is off by more than 1 %
};

/// Directed pairs that this rank's sweeps of a step go through and that lie within the support: those of water in two
/// sweeps, those of wet solid points in one. Not collective.
[[nodiscard]] std::int64_t interactions(const Particles& particles, const Neighbours& neighbours, double support);

[[nodiscard]] WaterState measure(const Simulation& simulation, const Scene& scene);

/// Water level [m] (along the direction against gravity) in the column at `gauge.position`: top of the highest particle
/// connected to those below by gaps of less than two particle distances; NaN in a dry column.
[[nodiscard]] double water_level(const Simulation& simulation, const Scene& scene, const Gauge& gauge);
/// Pressure [Pa] at a point, extrapolated from the water around as for walls; NaN where there is none.
[[nodiscard]] double pressure_at(const Simulation& simulation, const Gauge& gauge);
/// Farthest place [m] of connected water along `gauge.direction`.
[[nodiscard]] double front_position(const Simulation& simulation, const Gauge& gauge);

}  // namespace embacle::mps
