// Periodic directions of the domain: what leaves on one side enters on the other.
#pragma once

#include <array>
#include <cmath>

#include "scene/scene.hpp"

namespace embacle::mps {

struct Periodic {
  std::array<double, 3> lower{};   ///< [m]
  std::array<double, 3> length{};  ///< of the domain where it is periodic, else 0 [m]

  [[nodiscard]] bool any() const { return length != std::array<double, 3>{}; }
  [[nodiscard]] bool in(int axis) const { return length[axis] > 0; }

  /// Moves a place into the domain.
  void wrap(double* x) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!in(axis)) continue;
      x[axis] -= std::floor((x[axis] - lower[axis]) / length[axis]) * length[axis];
      if (x[axis] >= lower[axis] + length[axis]) x[axis] = lower[axis];  // by rounding
    }
  }
  /// The difference of two places along an axis, of the nearest of their images.
  [[nodiscard]] double nearest(int axis, double difference) const {
    return in(axis) ? difference - std::round(difference / length[axis]) * length[axis] : difference;
  }
};

[[nodiscard]] inline Periodic periodic_of(const Scene& scene) {
  Periodic result;
  for (int axis = 0; axis < scene.dimension; ++axis) {
    if (!scene.is_periodic(axis)) continue;
    result.lower[axis] = scene.domain.lower[axis];
    result.length[axis] = scene.domain.upper[axis] - scene.domain.lower[axis];
  }
  return result;
}

}  // namespace embacle::mps
