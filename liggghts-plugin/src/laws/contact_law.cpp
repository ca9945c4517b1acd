#include "laws/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace embacle::liggghts::laws {

double largest_ratio() { return std::sqrt(10.0) / 3; }

double restitution_of(double ratio) {
  const double b = ratio / largest_ratio();
  if (b >= 1) return 0;
  return std::exp(-std::numbers::pi * b / std::sqrt(1 - b * b));
}

double ratio_of(double restitution) {
  const double logarithm = std::log(restitution);
  return -largest_ratio() * logarithm / std::hypot(logarithm, std::numbers::pi);
}

double contact_duration(const Pair& pair, double speed) {
  if (speed <= 0) return 0;
  // (15/16)^(2/5) times the integral of 2/sqrt(1 - x^(5/2)) from 0 to 1.
  constexpr double factor = 2.86827;
  return factor * std::pow(pair.mass * pair.mass / (pair.length * pair.modulus * pair.modulus * speed), 0.2);
}

Vec3 tangential_force(Spring& spring, const Coefficients& coefficients, const Vec3& normal, const Vec3& slip,
                      double limit, double slip_velocity, double step, bool advance) {
  const double stiffness = coefficients.tangential_stiffness;
  Vec3 stretch = spring.stretch;
  if (advance) {
    if (stiffness > spring.stiffness && spring.stiffness > 0) stretch *= spring.stiffness / stiffness;
    stretch += step * slip;
    stretch -= stretch.dot(normal) * normal;  // the contact may have turned
  }
  Vec3 force = -stiffness * stretch - coefficients.tangential_damping * slip;
  const double speed = slip.norm();
  const double friction = limit * std::tanh(speed / slip_velocity);
  if (force.squaredNorm() > friction * friction) {
    const Vec3 direction = speed > 0 ? Vec3(slip / speed) : Vec3::Zero();
    force = -friction * direction;
    stretch = std::min(stretch.norm(), friction / stiffness) * direction;
  }
  if (advance) {
    spring.stretch = stretch;
    spring.stiffness = stiffness;
  }
  return force;
}

}  // namespace embacle::liggghts::laws
