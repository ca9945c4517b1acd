// A convex body as contacts see it: its faces, and which places inside are nearest to which face. No LIGGGHTS here.
#pragma once

#include <string>
#include <vector>

#include "embacle/coupling/shape.hpp"

namespace embacle::liggghts {

/// The half-space normal . x <= offset; the normal is a unit vector only where that is said.
struct HalfSpace {
  coupling::Vec3 normal;
  double offset;  ///< [m], with a unit normal
};

/// A flat polygon that is cut by half-spaces (Sutherland & Hodgman 1974, doi:10.1145/360767.360802).
class Polygon {
 public:
  /// The corners of a square of half the edge `reach` [m] in the plane through `centre`.
  void set_square(const coupling::Vec3& centre, const coupling::Vec3& unit_normal, double reach);
  void set(const std::vector<coupling::Vec3>& corners) { corners_ = corners; }
  /// Keeps what lies in the half-space; false if nothing is left.
  bool cut(const HalfSpace& half_space);
  [[nodiscard]] const std::vector<coupling::Vec3>& corners() const { return corners_; }
  /// Half the sum of the cross products of its corners: area times normal [m^2].
  [[nodiscard]] coupling::Vec3 area() const;

 private:
  std::vector<coupling::Vec3> corners_, spare_;
  std::vector<double> above_;  ///< distance of each corner beyond the half-space of the last cut
};

/// In the body frame of the shape it was made of.
struct ConvexShape {
  /// A face, and the part of the body for which it is the nearest.
  struct Face {
    HalfSpace outside;              ///< unit normal outwards; depth below the face = offset - normal . x
    std::vector<HalfSpace> region;  ///< the places inside the body that are nearest to this face
    std::vector<int> corners;       ///< of the face, as indices
    coupling::Vec3 centre;          ///< of a sphere around the region [m]
    double reach = 0;               ///< its radius [m]
    double area = 0;                ///< of the face [m^2]
  };
  std::vector<Face> faces;
  std::vector<coupling::Vec3> corners;  ///< [m]
  double reach = 0;                     ///< radius of the sphere about the origin that holds the body [m]
  double thickness = 0;                 ///< twice the greatest depth inside [m]
};

/// Flat sides that stand for a cylinder's mantle.
inline constexpr int cylinder_sides = 48;

/// The faces of a shape. The mantle of a cylinder becomes flat sides of the same cross-section area. Throws InputError
/// for a sphere and for a shape that is not convex; `where` begins the message.
ConvexShape convex_shape(const coupling::Shape& shape, const std::string& where);

}  // namespace embacle::liggghts
