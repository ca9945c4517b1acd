#include "contact/floe_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace embacle::liggghts {

using coupling::Vec3;

double damping_number(double restitution) {
  const double e = std::clamp(restitution, least_restitution, 1.0);
  if (e > 1 - 1e-12) return 0;
  // The root is simple and below 1 / e, where the right side has its pole.
  const auto excess = [e](double x) { return std::log1p(x) - std::log1p(-x * e) - x * (1 + e); };
  double low = 0, high = 1 / e;
  // The difference is negative for small x > 0 (its leading term is (e^2 - 1) x^2 / 2), positive next to the pole.
  for (int step = 0; step < 200; ++step) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (excess(middle) < 0 ? low : high) = middle;
  }
  return low;
}

ContactMaterial ContactMaterial::with(double restitution, double friction, double poisson_ratio) {
  const double logarithm = std::log(std::clamp(restitution, least_restitution, 1.0));
  return {friction, 0.5 / (1 + poisson_ratio), liggghts::damping_number(restitution),
          -logarithm / std::hypot(std::numbers::pi, logarithm)};
}

namespace {

/// Of a spring whose stiffness changes: the energy that it stores stays, so that a contact that trembles neither loses
/// its hold bit by bit nor gains energy.
double rescaled(double old_stiffness, double stiffness) {
  return old_stiffness > 0 ? std::sqrt(stiffness / old_stiffness) : 1.0;
}

}  // namespace

coupling::Load contact_force(const Patch& patch, const RigidMotion& first, const RigidMotion& second,
                             const ContactMaterial& material, const ContactSurroundings& around, bool advance,
                             ContactMemory& memory) {
  coupling::Load load;
  Vec3 elastic = Vec3::Zero(), centre = Vec3::Zero();
  double weight = 0;
  for (const auto& place : patch.places) {
    elastic += place.force;
    centre += place.size * place.position;
    weight += place.size;
  }
  if (weight <= 0) return load;
  centre /= weight;
  const double elastic_force = elastic.norm();
  const Vec3 normal = elastic_force > 1e-9 * weight ? Vec3(elastic / elastic_force) : Vec3::Zero();

  // The relative motion, once for all places: approach at x = approach + turning . (x - centre).
  const Vec3 relative = first.velocity_at(centre) - second.velocity_at(centre);
  const Vec3 spin = first.angular_velocity - second.angular_velocity;
  const double approach = -relative.dot(normal);
  const Vec3 turning = -normal.cross(spin);

  const double yield = first.yield(centre, normal) + second.yield(centre, normal);
  if (advance) {
    if (memory.touching == 0) {
      memory = ContactMemory{};
      memory.touching = memory.loading = 1;
      memory.reference_speed = std::max(0.0, approach);
    } else if (approach <= 0) {
      memory.loading = 0;
    } else if (memory.loading > 0) {
      memory.reference_speed = std::max(memory.reference_speed, approach);
    } else {
      constexpr double share = 0.1;  // twice that of the depth: soft contacts settle soon, and stacks soon stop to sway
      memory.reference_speed =
          std::sqrt(approach * approach + share * around.gravity * elastic_force / patch.stiffness);
      memory.loading = 1;
    }
  }
  const double number = material.damping_number;
  const double slowest = number * elastic_force * yield * around.dt * std::max(1.0, 0.5 * around.crowd);
  const double speed = std::max({memory.reference_speed, slowest, 1e-300});
  const double damping = number / speed;

  // Turning about the centre of pressure takes up no energy if it is steady, as in rolling: it is damped by a share of
  // what restitution asks, by the speed of the patch's rim, which lets rocking die out within some tens of periods.
  constexpr double rocking = 0.1;
  double rim = 0;
  for (const auto& place : patch.places) rim = std::max(rim, turning.dot(place.position - centre));
  const double turning_damping = number * rocking / std::max(rim, rocking * speed);

  for (const auto& place : patch.places) {
    const double closing = damping * approach + turning_damping * turning.dot(place.position - centre);
    const Vec3 force = std::max(0.0, 1 + closing) * place.force;
    load.force += force;
    load.torque += place.position.cross(force);
  }
  // The mean distance of the pressure from its centre is 0.87 (on a line) to 0.94 (on a disc) of the root of its mean
  // square, which is known exactly: what the places give depends on how the patch falls into triangles, and a spring
  // whose stiffness jumps from step to step shakes its bodies.
  const double lever = 0.9 * std::sqrt(std::max(0.0, patch.spread / weight - centre.squaredNorm()));

  const double limit = material.friction * std::max(0.0, load.force.dot(normal));
  if (material.friction <= 0 || limit <= 0) return load;
  const double stiffness = material.shear_stiffness * patch.stiffness;
  const double twist_stiffness = stiffness * lever * lever;
  const Vec3 sliding = relative - relative.dot(normal) * normal;
  const double twisting = spin.dot(normal);
  Vec3 spring(memory.spring[0], memory.spring[1], memory.spring[2]);
  const double stretched = spring.norm();
  spring -= spring.dot(normal) * normal;  // the normal has turned since: keep the size
  if (spring.squaredNorm() > 0) spring *= stretched / spring.norm();
  double twist = memory.twist;
  // Force and torque on one scale [N]; friction is limited in it.
  const auto grip = [lever](const Vec3& force, double torque) {
    const double twisting_force = lever > 0 ? torque / lever : 0.0;
    return std::sqrt(force.squaredNorm() + twisting_force * twisting_force);
  };
  if (advance) {
    spring *= rescaled(memory.spring_stiffness, stiffness);
    twist *= lever > 0 ? rescaled(memory.twist_stiffness, twist_stiffness) : 0.0;
    const double before = grip(spring, twist);
    spring -= stiffness * around.dt * sliding;
    twist -= twist_stiffness * around.dt * twisting;
    // While damping pulls the bodies together less, they slide, but the springs stay as they are: they never take up
    // more than what the bodies give.
    const double after = grip(spring, twist);
    const double most = std::min(material.friction * elastic_force, std::max(limit, before));
    if (after > most) {
      spring *= most / after;
      twist *= most / after;
    }
  }
  const double mass = 1 / (first.inverse_mass + second.inverse_mass);
  const double drag = 2 * material.damping_ratio * std::sqrt(stiffness * mass);
  Vec3 friction = spring - drag * sliding;
  double torque = twist - drag * lever * lever * twisting;
  const double size = grip(friction, torque) / limit;
  if (size > 1) {
    friction /= size;
    torque /= size;
  }
  if (advance) {
    memory.spring = {spring.x(), spring.y(), spring.z()};
    memory.spring_stiffness = stiffness;
    memory.twist = twist;
    memory.twist_stiffness = twist_stiffness;
  }
  load.force += friction;
  load.torque += centre.cross(friction) + torque * normal;
  return load;
}

}  // namespace embacle::liggghts
