// A rigid geometry, registered once and shared by all bodies that are instances of it.
// Both participants derive what they need from the same description: mass properties, the fluid's boundary
// points, the covering spheres of the solid, so nothing is written twice.
#pragma once

#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

enum class ShapeKind : int { box, sphere, cylinder };

/// Exact mass properties of a homogeneous shape about its centre of mass, in the body frame (principal axes).
struct MassProperties {
  double volume = 0;            ///< [m^3]
  double mass = 0;              ///< [kg]
  Vec3 inertia = Vec3::Zero();  ///< principal moments [kg m^2]
};

/// A point of a shape that the fluid sees, in the body frame.
struct ShapePoint {
  Vec3 position;               ///< relative to the centre of mass [m]
  Vec3 normal = Vec3::Zero();  ///< outward unit normal of the nearest face; zero for interior points
  double area = 0;             ///< share of the surface [m^2]; zero for interior points. Sums to the shape's area.
  [[nodiscard]] bool on_surface() const { return area > 0; }
};

/// A sphere of the solid's covering, in the body frame.
struct CoveringSphere {
  Vec3 centre;    ///< [m]
  double radius;  ///< [m]
};

/// A homogeneous rigid shape; the body frame has its origin at the centre of mass and the principal axes.
struct Shape {
  std::string name;
  ShapeKind kind = ShapeKind::box;
  /// box: full edge lengths x, y, z; sphere: {radius, 0, 0}; cylinder (axis along z): {radius, length, 0}. [m]
  Vec3 size = Vec3::Zero();
  double density = 0;  ///< [kg/m^3]

  [[nodiscard]] MassProperties mass_properties() const;
  /// Radius [m] of the smallest sphere about the centre of mass that contains the shape.
  [[nodiscard]] double bounding_radius() const;
  [[nodiscard]] double surface_area() const;  ///< [m^2]
  /// Signed distance [m] of a body-frame point to the surface, negative inside.
  [[nodiscard]] double signed_distance(const Vec3& point) const;

  /// Boundary points for the fluid: a lattice of about `spacing`, the outermost layer inset by half a spacing,
  /// down to `depth` below the surface (deeper points cannot be felt by the water and are left out).
  /// `dimension` 2 gives the slice z = 0 (areas are then lengths).
  [[nodiscard]] std::vector<ShapePoint> points(double spacing, double depth, int dimension = 3) const;

  /// Covering spheres for contacts: inscribed (touching the faces from inside), centres on a surface-only lattice of
  /// about `spacing`; `radius` 0 chooses half of the smallest edge divided by the number of layers that fit.
  [[nodiscard]] std::vector<CoveringSphere> covering_spheres(double spacing, double radius = 0) const;
};

}  // namespace embacle::coupling
