// The force of one contact: patch, restitution, friction. No LIGGGHTS here.
#pragma once

#include "contact/patch.hpp"

namespace embacle::liggghts {

inline constexpr double least_restitution = 0.02;

/// What a pair of materials does in contact.
struct ContactMaterial {
  double friction = 0;           ///< Coulomb's coefficient, sticking and sliding
  double shear_stiffness = 0.4;  ///< of the patch, relative to its normal stiffness: 1 / (2 (1 + Poisson's ratio))
  double damping_number = 0;     ///< see damping_number
  double damping_ratio = 0;      ///< of friction's springs: of a linear spring with the same restitution

  /// With separation over approach speed `restitution`, 0 to 1; below least_restitution it acts as that.
  static ContactMaterial with(double restitution, double friction, double poisson_ratio);
};

/// A rigid body's motion, about any origin.
struct RigidMotion {
  coupling::Vec3 position = coupling::Vec3::Zero();  ///< of the place that has `velocity`; a body's centre of mass [m]
  coupling::Vec3 velocity = coupling::Vec3::Zero();  ///< [m/s]
  coupling::Vec3 angular_velocity = coupling::Vec3::Zero();  ///< [rad/s]
  double inverse_mass = 0;                                   ///< [1/kg]; 0: a wall
  coupling::Mat3 inverse_inertia = coupling::Mat3::Zero();   ///< global axes [1/(kg m^2)]

  [[nodiscard]] coupling::Vec3 velocity_at(const coupling::Vec3& x) const {
    return velocity + angular_velocity.cross(x - position);
  }
  /// Velocity that a unit impulse along `direction` at `x` gives that place along it [1/kg].
  [[nodiscard]] double yield(const coupling::Vec3& x, const coupling::Vec3& direction) const {
    const coupling::Vec3 arm = (x - position).cross(direction);
    return inverse_mass + arm.dot(inverse_inertia * arm);
  }
};

/// What a contact remembers from step to step while it lasts; plain numbers, for messages and checkpoints.
struct ContactMemory {
  double touching = 0;             ///< 1: there was a patch at the last step
  double loading = 0;              ///< 1: approached at the last step
  double reference_speed = 0;      ///< fastest approach since the present loading began [m/s]
  std::array<double, 3> spring{};  ///< elastic part of the friction on the first body [N]
  double spring_stiffness = 0;     ///< with which it was stretched [N/m]
  double twist = 0;                ///< elastic torque about the normal on the first body [N m]
  double twist_stiffness = 0;      ///< [N m/rad]
};
inline constexpr int contact_memory_size = sizeof(ContactMemory) / sizeof(double);

/// Damping times approach speed, x, for a coefficient of restitution e: x (1 + e) = ln((1 + x) / (1 - x e)). It holds
/// for F = U'(d) (1 + x v / v0) with approach speed v0 and any potential U, so for any number and stiffness of contacts
/// that act at once (Hunt & Crossley 1975, doi:10.1115/1.3423596, integrated exactly).
double damping_number(double restitution);

/// What a contact must know of the world around it.
struct ContactSurroundings {
  double dt = 0;       ///< time step [s]
  double gravity = 0;  ///< [m/s^2]
  double crowd = 1;    ///< contacts of the body that has more of them
};

/// Force [N] on the first body and its torque [N m] about the origin of the patch; the second body gets the opposite.
/// `advance`: the memory is to take part in the step; otherwise it stays as it is.
///
/// Pressure p (1 + x v / v0), at least 0, with v the approach speed at the centre of pressure along the mean normal and
/// v0 the reference speed: that of the first touch, and after a retreat the present one, with what free fall over a
/// twentieth of the present depth gives (without it a loaded contact would yield ever more slowly); at least the one at
/// which the damping of all contacts of a body would take away twice a step's motion, x F dt / m times half their
/// number. Turning about the centre adds a tenth of x w / w0, with w its approach speed at each place and w0 that of
/// the patch's rim, or a tenth of v0 if that is more: rocking dies out, and rolling loses little.
/// Friction: one spring of force and one of twist at the centre of pressure, damped as restitution asks, both limited
/// together by (T / mu F)^2 + (M / mu F r)^2 <= 1 with r the mean distance of the pressure from its centre, taken as
/// 0.9 of the root of its mean square. The springs never store more than the bodies gave them.
coupling::Load contact_force(const Patch& patch, const RigidMotion& first, const RigidMotion& second,
                             const ContactMaterial& material, const ContactSurroundings& around, bool advance,
                             ContactMemory& memory);

}  // namespace embacle::liggghts
