#include "contact/floe_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace embacle::liggghts {

using coupling::Vec3;

double damping_number(double restitution) {
  const double e = std::clamp(restitution, 0.02, 1.0);
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
  const double logarithm = std::log(std::clamp(restitution, 0.02, 1.0));
  return {friction, 0.5 / (1 + poisson_ratio), liggghts::damping_number(restitution),
          -logarithm / std::hypot(std::numbers::pi, logarithm)};
}

namespace {

/// The elastic part `stretched` follows its stiffness down, never up: what it stores may only be lost.
double weakened(double stretched, double old_stiffness, double stiffness) {
  return stiffness < old_stiffness ? stretched * (stiffness / old_stiffness) : stretched;
}

}  // namespace

coupling::Load contact_force(const Patch& patch, const RigidMotion& first, const RigidMotion& second,
                             const ContactMaterial& material, double dt, bool advance, ContactMemory& memory) {
  coupling::Load load;
  Vec3 elastic = Vec3::Zero(), centre = Vec3::Zero();
  double weight = 0;
  for (const auto& place : patch.places) {
    const double share = place.pressure * place.area.norm();
    elastic += place.pressure * place.area;
    centre += share * place.position;
    weight += share;
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

  if (advance) {
    if (memory.touching == 0) {
      memory = ContactMemory{};
      memory.touching = memory.loading = 1;
      memory.reference_speed = std::max(0.0, approach);
    } else if (approach > 0) {
      memory.reference_speed = memory.loading > 0 ? std::max(memory.reference_speed, approach) : approach;
      memory.loading = 1;
    } else {
      memory.loading = 0;
    }
  }
  const double number = material.damping_number;
  const double yield = first.yield(centre, normal) + second.yield(centre, normal);
  const double slowest = number * elastic_force * yield * dt;
  const double speed = std::max({memory.reference_speed, slowest, 1e-300});
  const double damping = number / speed;

  // Turning about the centre of pressure takes up no energy if it is steady, as in rolling: it is damped by a share of
  // what restitution asks, by the speed of the patch's rim, which lets rocking die out within some tens of periods.
  constexpr double rocking = 0.1;
  double rim = 0;
  for (const auto& place : patch.places) rim = std::max(rim, turning.dot(place.position - centre));
  const double turning_damping = number * rocking / std::max(rim, rocking * speed);

  double lever = 0;
  for (const auto& place : patch.places) {
    const double closing = damping * approach + turning_damping * turning.dot(place.position - centre);
    const Vec3 force = (place.pressure * std::max(0.0, 1 + closing)) * place.area;
    load.force += force;
    load.torque += place.position.cross(force);
    lever += place.pressure * place.area.norm() * (place.position - centre).norm();
  }
  lever /= weight;

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
  if (advance) {
    if (stretched > 0) spring *= weakened(1, memory.spring_stiffness, stiffness);
    twist = weakened(twist, memory.twist_stiffness, twist_stiffness);
    spring -= stiffness * dt * sliding;
    twist -= twist_stiffness * dt * twisting;
  }
  const double mass = 1 / (first.inverse_mass + second.inverse_mass);
  const double drag = 2 * material.damping_ratio * std::sqrt(stiffness * mass);
  Vec3 friction = spring - drag * sliding;
  double torque = twist - drag * lever * lever * twisting;
  const double most_twist = limit * lever;
  const double size = std::hypot(friction.norm() / limit, most_twist > 0 ? torque / most_twist : 0.0);
  if (size > 1) {
    friction /= size;
    torque /= size;
    if (advance) {
      spring = friction;
      twist = torque;
    }
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
