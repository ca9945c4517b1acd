// The free rotation of a rigid body in closed form (Landau & Lifshitz, Mechanics, section 37).
#pragma once

#include <array>
#include <cmath>

#include "embacle/coupling/types.hpp"

namespace embacle::liggghts {

struct Jacobi {
  double sn, cn, dn;
};

/// Jacobi's elliptic functions of argument u and modulus k in [0, 1), by descending Landen transformations (Abramowitz
/// & Stegun 16.4).
inline Jacobi jacobi(double u, double k) {
  std::array<double, 32> a{}, c{};
  a[0] = 1;
  double b = std::sqrt(1 - k * k);
  c[0] = k;
  int n = 0;
  while (std::abs(c[n]) > 1e-17 * a[n] && n < 30) {
    a[n + 1] = 0.5 * (a[n] + b);
    c[n + 1] = 0.5 * (a[n] - b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  double phi = std::ldexp(a[n] * u, n);
  for (; n > 0; --n) phi = 0.5 * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
  const double sn = std::sin(phi), cn = std::cos(phi);
  return {sn, cn, std::sqrt(1 - k * k * sn * sn)};
}

/// Complete elliptic integral of the first kind by the arithmetic-geometric mean.
inline double quarter_period(double k) {
  double a = 1, b = std::sqrt(1 - k * k);
  while (std::abs(a - b) > 1e-15 * a) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return M_PI / (a + b);
}

/// Body with principal moments I_1 < I_2 < I_3 [kg m2] that starts with the angular velocity (0, middle, third) [rad/s]
/// in its own frame, middle and third > 0; the frames agree at the start. Angular velocity by Jacobi's functions; the
/// angle of precession about the angular momentum is their integral, by Simpson's rule.
class FreeRotation {
 public:
  FreeRotation(const coupling::Vec3& moments, double middle, double third) : moments_(moments) {
    const double i1 = moments[0], i2 = moments[1], i3 = moments[2];
    momentum_ = std::hypot(i2 * middle, i3 * third);
    const double energy2 = i2 * middle * middle + i3 * third * third;  // twice the energy
    const double m2 = momentum_ * momentum_, over = energy2 * i3 - m2, under = m2 - energy2 * i1;
    largest_ = {std::sqrt(over / (i1 * (i3 - i1))), std::sqrt(over / (i2 * (i3 - i2))),
                std::sqrt(under / (i3 * (i3 - i1)))};
    rate_ = std::sqrt((i3 - i2) * under / (i1 * i2 * i3));
    modulus_ = std::sqrt((i2 - i1) * over / ((i3 - i2) * under));
    start_ = quarter_period(modulus_);
    to_global_ = about_momentum(0, 0).transpose();
  }

  /// [rad/s] in the body's frame.
  [[nodiscard]] coupling::Vec3 angular_velocity(double time) const {
    const auto [sn, cn, dn] = jacobi(rate_ * time + start_, modulus_);
    return {largest_[0] * cn, largest_[1] * sn, largest_[2] * dn};
  }

  /// Body frame to global frame. Steps of the quadrature per second: the integrand is smooth, 1000 are more than
  /// enough.
  [[nodiscard]] coupling::Mat3 orientation(double time, double steps_per_second = 1000) const {
    const int pairs = static_cast<int>(std::ceil(0.5 * steps_per_second * time)) + 1;
    const double step = time / (2 * pairs);
    double sum = precession(0) + precession(time);
    for (int k = 1; k < 2 * pairs; ++k) sum += (k % 2 == 1 ? 4 : 2) * precession(k * step);
    return to_global_ * about_momentum(time, sum * step / 3);
  }

 private:
  /// Rate [rad/s] of the first Euler angle about the angular momentum.
  [[nodiscard]] double precession(double time) const {
    const coupling::Vec3 w = angular_velocity(time);
    const double energy = moments_[0] * w[0] * w[0] + moments_[1] * w[1] * w[1];
    const double square = std::pow(moments_[0] * w[0], 2) + std::pow(moments_[1] * w[1], 2);
    return momentum_ * energy / square;
  }
  /// Body frame to a frame whose third axis is the angular momentum, by Euler angles z-x-z.
  [[nodiscard]] coupling::Mat3 about_momentum(double time, double angle) const {
    const coupling::Vec3 l = moments_.cwiseProduct(angular_velocity(time));
    const coupling::Vec3 x = coupling::Vec3::UnitX(), z = coupling::Vec3::UnitZ();
    return (Eigen::AngleAxisd(angle, z) * Eigen::AngleAxisd(std::atan2(std::hypot(l[0], l[1]), l[2]), x) *
            Eigen::AngleAxisd(std::atan2(l[0], l[1]), z))
        .toRotationMatrix();
  }

  coupling::Vec3 moments_, largest_ = coupling::Vec3::Zero();
  double momentum_ = 0, rate_ = 0, modulus_ = 0, start_ = 0;
  coupling::Mat3 to_global_ = coupling::Mat3::Identity();
};

}  // namespace embacle::liggghts
