// The particle operators: three sweeps over the neighbour lists a step.
#pragma once

#include <vector>

#include "core/constants.hpp"
#include "core/neighbours.hpp"
#include "core/particles.hpp"
#include "core/threads.hpp"

namespace embacle::mps {

/// A vector per particle.
using Triple = std::array<double, 3>;
using Reactions = ThreadSums<Triple>;

/// Continuity and equation of state of the own water:
///   ds/dt = -(d/n0) SUM (v_j - v_i).r_ij F + delta' c0 l0 (2d/(lambda n0)) SUM [(s_j - s_i) - g.r_ij/c0^2] F r^2,
/// the first sum over all neighbours, the second over water only, r_ij = r_j - r_i, F = W/r^2: thesis eq 5.16 with unit
/// weights, and eq 5.30 with the hydrostatic part removed and a coefficient that does not depend on the time step
/// (Fourtakas et al. 2019, doi:10.1016/j.compfluid.2019.06.009); with `diffusion = "plain"` it stays. Then p from the
/// equation of state.
/// `step` is by how long [s]; `back` is how long ago [s] the positions were those of the sum, by the present
/// velocities.
void advance_density(Particles& particles, const Neighbours& neighbours, const Constants& constants, double step,
                     double back);
/// By a whole step that led to the present positions, with the geometry of its middle.
inline void advance_density(Particles& particles, const Neighbours& neighbours, const Constants& constants) {
  advance_density(particles, neighbours, constants, constants.step, 0.5 * constants.step);
}

/// Pressure of the own solid points near water, extrapolated from it (Adami et al. 2012,
/// doi:10.1016/j.jcp.2012.05.005):
///   p_b = max(0, SUM F [p_f + rho0 (g - a_b).(r_b - r_f)] / SUM F).
/// `acceleration`: of each wet point, in the order of neighbours.wet_points() (empty: all at rest or steady) [m/s^2].
/// `part`: of the wet points.
void extrapolate_pressure(Particles& particles, const Neighbours& neighbours, const Constants& constants,
                          const std::vector<Triple>& acceleration, Part part = Part::all);

/// Acceleration [m/s^2] of the own water by pressure, viscosity, artificial viscosity, collisions and gravity:
///   a_i = g - (d/(rho0 n0)) SUM (p_i + p_j) r_ij F + (d/n0) alpha c0 l0 SUM ((v_j - v_i).r_ij/r^2) r_ij F
///         + nu (2d/(lambda n0)) SUM (v_j - v_i) F r^2 + collisions,
/// the conjugate of the divergence above, so that pressure work and compression balance (thesis eq 5.15 with unit
/// weights over the constant rho0, which keeps the pair forces antisymmetric). Walls and bodies enter the viscous sum
/// with the mirrored velocity 2 v_b - v_i (no slip), only where the scene has a viscosity; otherwise they slip. Where
/// walls say whether they slip, they and the bodies are left to Friction.
/// Collisions: pairs closer than the collision distance and approaching exchange the normal velocity
/// (1 + epsilon)/2 (v_ij.e) e (thesis eq 5.38 with its sign corrected), on all water pairs; with a solid point the
/// water takes (1 + epsilon) (v_ij.e) e when it is within half a particle distance, i.e. at the surface.
/// `reaction`: exact opposite of the force [N] on each solid point; slots as given by reaction_slot(); to be joined.
/// `part`: of the water; all of it, or first the inner part and then the rim.
void accelerate(const Particles& particles, const Neighbours& neighbours, const Constants& constants,
                std::vector<Triple>& acceleration, Reactions& reaction, Part part = Part::all);

/// Power [W] by which the own water compresses the solid points, as if they were water at their pressure:
///   (m/rho0) (d/n0) SUM p_b (v_i - v_b).r_ib F,
/// the part of the pressure's work on the water that no density of water answers. Half a step of `acceleration` is
/// taken off the velocities, which are ahead by that much.
[[nodiscard]] double power_into_solids(const Particles& particles, const Neighbours& neighbours,
                                       const Constants& constants, const std::vector<Triple>& acceleration);

/// Slot of a solid point (own or ghost) or of the sentinel in the reaction array.
[[nodiscard]] inline std::size_t reaction_slot(const Particles& particles, std::size_t j) {
  return j < particles.own() ? j - particles.water : j - particles.own() - particles.ghost_water + particles.solid;
}
[[nodiscard]] inline std::size_t reaction_slots(const Particles& particles) {
  return particles.solid + particles.ghost_solid + 1;
}

}  // namespace embacle::mps
