// Per-sphere contact laws of two publications, free of LIGGGHTS. SI units throughout.
//
// [T] A. Mellado Cusicahua, "A fully Lagrangian model using DEM-WCMPS to simulate solid objects in free-surface flow
// with
//     applications to river ice dynamics", Polytechnique Montreal, 2021, section 4.2
//     (https://publications.polymtl.ca/6598/).
// [P] The paper in its appendix A (DEM-WCMPS for river ice against dam breaks with floating blocks), section 4.2.
//
// Deviations from the printed equations, each named again where it is made:
//   [T] 4.15  minimum of the magnitudes, not of the vectors
//   [T] 4.17  8 s/m made explicit as a slip velocity of 1/8 m/s: the argument of tanh must have no dimension
//   [T] 4.23  k_t lacks the factor sqrt(overlap), [T] 4.24 gamma_t lacks overlap^(1/4): without them neither is in N/m,
//   N s/m [T] 4.25  the slip is summed over the contact; the slip of one step makes the spring vanish with the time
//   step [T] 4.26  lacks the exponent 1/5 [P] 20    the Young's moduli in the denominator of E_kl are exchanged [P] 21
//   8/l_kl stands for a slip velocity l_kl/(8 s) [P] 22    the second "relative sliding" is the sliding velocity; the
//   slip is summed over the contact
#pragma once

#include <cmath>

#include "embacle/coupling/types.hpp"

namespace embacle::liggghts::laws {

using coupling::Vec3;

/// What the two sides of a contact bring into a law.
struct Pair {
  double modulus = 0;  ///< Y* [Pa], 1/Y* = (1 - nu_i^2)/Y_i + (1 - nu_j^2)/Y_j ([T] 4.12; [P] 20 corrected)
  double length = 0;   ///< [m]; R* of [T] 4.13, l_kl of [P] 20
  double mass = 0;     ///< m* [kg], of the bodies if the spheres belong to bodies ([T] 4.14 and section 4.3)
  double damping = 0;  ///< contact ratio epsilon_n of [T], damping ratio xi_n of [P] [-]
};

/// Force = stiffness * way + damping * speed, in the normal direction and across it.
struct Coefficients {
  double normal_stiffness = 0;      ///< secant: elastic force / overlap [N/m]
  double normal_damping = 0;        ///< [N s/m]
  double tangential_stiffness = 0;  ///< [N/m]
  double tangential_damping = 0;    ///< [N s/m]
};

/// [T] 4.10, 4.11, 4.23, 4.24: Hertz' force with damping ~ overlap^(1/4); across it 2/7 of both. Overlap [m] >= 0.
[[nodiscard]] inline Coefficients contact_ratio_law(const Pair& pair, double overlap) {
  const double base = pair.modulus * std::sqrt(pair.length * overlap);
  Coefficients c;
  c.normal_stiffness = 4.0 / 3 * base;
  c.normal_damping = pair.damping * std::sqrt(6 * pair.mass * base);
  c.tangential_stiffness = 2.0 / 7 * c.normal_stiffness;  // 8/21 Y* sqrt(R* overlap)
  c.tangential_damping = 2.0 / 7 * c.normal_damping;
  return c;
}

/// [P] 19 and 22: the same normal law in its own length; across it a linear spring and dashpot.
[[nodiscard]] inline Coefficients river_ice_law(const Pair& pair, double overlap) {
  Coefficients c = contact_ratio_law(pair, overlap);
  // 2/7 k_n sqrt(l0) and 2/7 c_n l0^(1/4), with k_n in N/m^(3/2) and l0 = 2 l_kl, as of equal particles.
  const Coefficients at_spacing = contact_ratio_law(pair, 2 * pair.length);
  c.tangential_stiffness = at_spacing.tangential_stiffness;
  c.tangential_damping = at_spacing.tangential_damping;
  return c;
}

/// R* [m] of two radii ([T] 4.13). With a wall it is the sphere's radius.
[[nodiscard]] inline double effective_radius(double radius_i, double radius_j) {
  return radius_i * radius_j / (radius_i + radius_j);
}

/// l_kl [m] of the diameters of two spheres ([P] 20, where l is the distance of particles). With a wall, which in [P]
/// is made of particles as large as the sphere, it is the sphere's radius.
[[nodiscard]] inline double effective_spacing(double radius_i, double radius_j) {
  return 2 * effective_radius(radius_i, radius_j);
}

/// Slip velocity [m/s] of the tanh of [T] 4.17.
inline constexpr double contact_ratio_slip_velocity = 1.0 / 8;
/// Slip velocity [m/s] of the tanh of [P] 21, with l_kl [m].
[[nodiscard]] inline double river_ice_slip_velocity(double spacing) { return spacing / 8; }

/// Largest contact ratio: critical damping, no rebound. sqrt(10)/3.
[[nodiscard]] double largest_ratio();
/// Coefficient of restitution that a contact ratio in [0, largest_ratio()] gives, whatever speed and stiffness, if the
/// contact ends where the overlap ends (Tsuji, Tanaka & Ishida, Powder Technology 71 (1992) 239): exp(-pi b / sqrt(1 -
/// b^2)) with b = 3/sqrt(10) ratio.
[[nodiscard]] double restitution_of(double ratio);
/// Inverse of restitution_of for a restitution in (0, 1].
[[nodiscard]] double ratio_of(double restitution);

/// Duration [s] of an undamped collision at a relative speed [m/s] ([T] 4.26 with its exponent 1/5). 0 if speed is 0.
[[nodiscard]] double contact_duration(const Pair& pair, double speed);

/// Tangential spring of a contact: what LIGGGHTS keeps in the contact history.
struct Spring {
  Vec3 stretch = Vec3::Zero();  ///< summed slip [m]
  double stiffness = 0;         ///< of the last step [N/m]
};

/// Force [N] on sphere i across the contact ([T] 4.15, 4.17, 4.22; [P] 21, 22, 24): spring and dashpot, or Coulomb's
/// friction, limit * tanh(|slip| / slip_velocity) against the slip, whichever is smaller.
///
/// slip: velocity [m/s] of i relative to j at the contact, normal to `normal`; limit: friction coefficient times
/// |normal force| [N]; step [s]. The spring is advanced if `advance`. It never holds more than the friction that acts:
/// then no cycle of slips yields energy. Where the stiffness has grown since the last step the force is kept, not the
/// stretch, for the same reason.
[[nodiscard]] Vec3 tangential_force(Spring& spring, const Coefficients& coefficients, const Vec3& normal,
                                    const Vec3& slip, double limit, double slip_velocity, double step, bool advance);

}  // namespace embacle::liggghts::laws
