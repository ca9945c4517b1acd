// Shapes of walls and of water other than boxes: signed distance, normal, and the points that represent a wall.
#pragma once

#include <optional>
#include <vector>

#include "embacle/coupling/closed_surface.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// A cylinder, sphere or prism, or what a closed surface encloses. In 2-D the first two are discs and a prism is a
/// polygon.
class Solid {
 public:
  Solid(const Form& form, int dimension);

  /// Distance [m] of a place to the surface, negative inside; `normal` (unless null): outward unit vector of the
  /// nearest place on the surface.
  [[nodiscard]] double distance(const double* x, Vec3d* normal = nullptr) const;

  [[nodiscard]] double volume() const;  ///< [m^3], in 2-D [m^2]

  /// Points of a wall of this shape down to `depth` [m]: layers of about `spacing` parallel to the surface, the
  /// outermost inset by half of it.
  [[nodiscard]] std::vector<Vec3d> points(double spacing, double depth) const;

 private:
  /// In the plane across the axis: of the disc or the polygon.
  double planar_distance(double u, double v, double& nu, double& nv) const;
  [[nodiscard]] std::vector<Vec3d> round_points(double spacing, double depth) const;

  Form form_;
  int dimension_;
  int u_, v_, w_;              ///< axes across and along
  double low_ = 0, high_ = 0;  ///< ends along the axis
  std::optional<coupling::ClosedSurface> mesh_;
};

}  // namespace embacle::mps
