// A rigid geometry, registered once and shared by all bodies that are instances of it.
// Both participants derive what they need from the same description: mass properties, the fluid's boundary
// points, the covering spheres of the solid, so nothing is written twice.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "embacle/coupling/closed_surface.hpp"
#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

enum class ShapeKind : int { box, sphere, cylinder, prism, surface };

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

/// A piece of a plane face, or of a curved one taken as plane, that belongs to a point of the fluid; in the body frame.
struct SurfacePiece {
  int point;   ///< index into the points
  Vec3 place;  ///< its centroid, on the surface [m]
  Vec3 area;   ///< times the outward normal [m^2]; the areas of a prism or surface sum to zero
};

/// What a covering lacks and what it has too much; lengths [m], volumes as shares of the shape's volume.
///
/// Gap: distance from a place of the shape's surface to the nearest sphere's surface, zero if inside a sphere. Outside:
/// the part of the union of the spheres that lies outside the shape. Missing: the part of the shape outside all spheres
/// that is nearer to the surface than one radius of the largest sphere; deeper, a covering may be hollow. The largest
/// gap and the largest protrusion together are the Hausdorff distance of the two surfaces, seen from outside.
struct CoveringError {
  double largest_gap = 0;         ///< [m]
  double mean_gap = 0;            ///< over the shape's surface [m]
  double largest_protrusion = 0;  ///< of a sphere out of the shape [m]
  double outside_volume = 0;      ///< share of the shape's volume
  double missing_volume = 0;      ///< share of the shape's volume
  double size = 0;                ///< cube root of the shape's volume [m]: lengths are relative to it in reports
};

struct Polyhedron;

/// A homogeneous rigid shape; the body frame has its origin at the centre of mass and the principal axes.
struct Shape {
  std::string name;
  ShapeKind kind = ShapeKind::box;
  /// box: full edge lengths x, y, z; sphere: {radius, 0, 0}; cylinder (axis along z): {radius, length, 0}; prism (axis
  /// along z) and surface: edges of the box around it in the body frame. [m]
  Vec3 size = Vec3::Zero();
  double density = 0;                                      ///< [kg/m^3]
  std::shared_ptr<const Polyhedron> polyhedron = nullptr;  ///< of a prism or surface
  /// Centre of mass [m] and principal axes in the frame in which a prism or surface was given.
  Vec3 given_centre = Vec3::Zero();
  Quaternion given_axes = Quaternion::Identity();

  [[nodiscard]] MassProperties mass_properties() const;
  /// Radius [m] of the smallest sphere about the centre of mass that contains the shape.
  [[nodiscard]] double bounding_radius() const;
  [[nodiscard]] double surface_area() const;  ///< [m^2]
  /// Signed distance [m] of a body-frame point to the surface, negative inside.
  [[nodiscard]] double signed_distance(const Vec3& point) const;

  /// Corners [m] of the axis-aligned box around the shape in an orientation, relative to the centre of mass; exact.
  [[nodiscard]] Box extents(const Quaternion& orientation) const;
  /// Radius [m] of the largest sphere inside the shape.
  [[nodiscard]] double inscribed_radius() const;

  /// Boundary points for the fluid: a lattice of about `spacing`, the outermost layer inset by half a spacing,
  /// down to `depth` below the surface (deeper points cannot be felt by the water and are left out).
  /// `dimension` 2 gives the slice z = 0 (areas are then lengths). `pieces`, unless null: the faces, divided among the
  /// points.
  [[nodiscard]] std::vector<ShapePoint> points(double spacing, double depth, int dimension = 3,
                                               std::vector<SurfacePiece>* pieces = nullptr) const;

  /// Covering spheres for contacts, all inside the shape, of one radius, and touching its faces. The centres of a box
  /// or cylinder are a lattice of about `spacing` at that depth. Those of a prism or surface are chosen one by one
  /// (Eldar et al. 1997, doi:10.1109/83.623193), each where it is farthest from all others, until no place at that
  /// depth is farther from a centre than in a square lattice of `spacing`: spacing / sqrt 2. A corner goes before any
  /// other place that is at most sqrt 2 farther. `radius` 0: the largest sphere inside divided by the number of layers
  /// of `spacing` that fit; of a surface, see covering_spheres_of_count. Throws InputError.
  [[nodiscard]] std::vector<CoveringSphere> covering_spheres(double spacing, double radius = 0) const;
  /// Likewise with at most `count` spheres: as many as the lattice allows; of a prism or surface exactly `count`,
  /// unless fewer leave no place for another. `radius` 0 chooses, of the largest sphere inside and its parts by powers
  /// of sqrt 2 down to an eighth, the radius with the smallest largest gap (of a lattice: that of its spacing). Throws
  /// InputError if the shape needs more spheres.
  [[nodiscard]] std::vector<CoveringSphere> covering_spheres_of_count(int count, double radius = 0) const;
  /// Measures a covering. Gaps at the parts of visit_surface (at most a quarter of the smallest radius, or as small as
  /// 20 000 parts allow), volumes at 2^18 places that fill the box evenly (Kronecker sequence of the plastic number):
  /// to about 1e-3 of the box.
  [[nodiscard]] CoveringError covering_error(const std::vector<CoveringSphere>& spheres) const;
  /// The surface in small parts of at most `spacing` [m]: visits the centroid of each and its area times normal [m^2];
  /// beside them sharp corners and rims, with area zero.
  void visit_surface(double spacing, const std::function<void(const Vec3&, const Vec3&)>& visit) const;
};

/// What bodies of plane faces are made of, in the body frame.
struct Polyhedron {
  ClosedSurface surface;
  double volume = 0;                     ///< [m^3]
  Vec3 inertia = Vec3::Zero();           ///< principal moments at unit density [m^5]
  std::vector<Eigen::Vector2d> polygon;  ///< cross-section of a prism, counterclockwise [m]; empty for a surface
};

/// A prism along z with the polygon's corners [m], in either sense, as cross-section. Throws InputError for a polygon
/// that has fewer than three corners, crosses itself or touches itself.
Shape make_prism(const std::vector<Eigen::Vector2d>& corners, double length, double density);
/// What a closed surface encloses (see parse_stl). Throws InputError if its volume is not positive.
Shape make_solid(const std::vector<Triangle>& triangles, double density);
/// The same shape from what another rank knows of it: triangles and polygon in the body frame.
std::shared_ptr<const Polyhedron> make_polyhedron(std::vector<Triangle> triangles,
                                                  std::vector<Eigen::Vector2d> polygon);

}  // namespace embacle::coupling
