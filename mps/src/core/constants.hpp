// What a scene's numbers come to, once: constants of the discretisation, in SI.
#pragma once

#include <array>
#include <utility>

#include "core/kernel.hpp"
#include "core/periodic.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// What can limit the time step.
enum class StepLimit { acoustic, viscous, force, bodies, count };
inline constexpr std::array<const char*, static_cast<std::size_t>(StepLimit::count)> step_limit_names = {
    "acoustic", "viscous", "force", "bodies"};
inline const char* name_of(StepLimit limit) { return step_limit_names[static_cast<std::size_t>(limit)]; }

struct Constants {
  int dimension = 3;
  double particle_distance = 0;  ///< l0 [m]
  double support = 0;            ///< r_e [m]
  double skin = 0;               ///< of the neighbour lists [m]
  int layers = 0;                ///< of wall points needed to fill the support
  KernelKind kernel = KernelKind::wendland;
  double density = 0;                          ///< rho0 [kg/m^3]
  double particle_mass = 0;                    ///< rho0 l0^d (times the thickness in 2-D) [kg]
  double reference_speed = 0;                  ///< largest speed expected [m/s]
  double sound_speed = 0;                      ///< c0 [m/s]
  double step = 0;                             ///< time step [s]: the longest, or with adaptive steps the present one
  StepLimit step_limit = StepLimit::acoustic;  ///< what keeps it from being longer at the reference speed
  double cfl = 0;
  double gravity[3] = {0, 0, 0};  ///< [m/s^2]
  double static_gravity[3] = {};  ///< the part that pressure can balance: not along periodic directions [m/s^2]
  /// Gravity whose hydrostatic density the density diffusion leaves alone; zero: none [m/s^2].
  double diffusion_gravity[3] = {};
  double central_force = 0;      ///< k of the acceleration -k (x - centre) [1/s^2]
  double centre[3] = {0, 0, 0};  ///< of the central force [m]
  Periodic periodic;
  double gradient_factor = 0;       ///< d/n0
  double laplacian_factor = 0;      ///< 2 d/(lambda n0)
  double viscosity = 0;             ///< kinematic [m^2/s]
  bool wall_friction = false;       ///< the viscous term of solids is that of Friction, not of accelerate()
  double artificial_viscosity = 0;  ///< alpha c0 l0 [m^2/s]
  double density_diffusion = 0;     ///< delta' c0 l0 [m^2/s]
  bool plain_operators = false;     ///< with shifting: neither corrected to first order nor carried along (ALE)
  double shifting = 0;              ///< strength of particle shifting, 1 as published
  double crowding_factor = 0;       ///< d/n0 of the rational weight, by which particles are shifted
  double collision_distance = 0;    ///< [m]
  double smagorinsky = 0;           ///< coefficient Cs of the eddy viscosity; 0: none
  double collision_restitution = 0;
  LatticeSums lattice;
};

/// Reference speed [m/s] from the hydraulic head of the water, its initial velocity and the walls' motion, unless
/// given.
[[nodiscard]] double reference_speed(const Scene& scene);
/// The fastest motions and the largest acceleration at a moment.
struct Motions {
  double water = 0;         ///< speed [m/s]
  double bodies = 0;        ///< speed of the fastest point [m/s]
  double acceleration = 0;  ///< of the water [m/s^2]
};
/// The longest time step [s] that sound, viscosity, forces and bodies allow (Monaghan 1992,
/// doi:10.1146/annurev.aa.30.090192.002551), and which of them it is:
///   cfl l0/(c0 + u), 0.125 l0^2/nu, 0.25 (l0/a)^(1/2), with the speed of the water or of the bodies.
[[nodiscard]] std::pair<double, StepLimit> longest_step(const Constants& constants, const Motions& motions);

[[nodiscard]] Constants constants_of(const Scene& scene);

/// Potential [m^2/s^2] of the central force at a place, zero at its centre.
inline double central_potential(const Constants& c, const double* x) {
  double square = 0;
  for (int k = 0; k < c.dimension; ++k) square += (x[k] - c.centre[k]) * (x[k] - c.centre[k]);
  return 0.5 * c.central_force * square;
}

/// Pressure [Pa] of the Tait equation of state (thesis eq 5.17, gamma = 7) and its inverse.
inline double pressure_of(double s, const Constants& c) {
  const double s2 = s * s;
  return c.density * c.sound_speed * c.sound_speed / 7.0 * (s2 * s2 * s2 * s - 1.0);
}
inline double density_ratio_of(double pressure, const Constants& c) {
  return std::pow(1.0 + 7.0 * pressure / (c.density * c.sound_speed * c.sound_speed), 1.0 / 7.0);
}

}  // namespace embacle::mps
