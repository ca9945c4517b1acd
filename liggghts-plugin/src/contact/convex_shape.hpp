// A convex body as contacts see it: its faces, and which places inside are nearest to which face. No LIGGGHTS here.
#pragma once

#include <functional>
#include <string>

#include "contact/flat_polygon.hpp"

namespace embacle::liggghts {

/// In the body frame of the shape it was made of.
struct ConvexShape {
  /// A face, and the part of the body for which it is the nearest.
  struct Face {
    HalfSpace outside;              ///< unit normal outwards; depth below the face = offset - normal . x
    std::vector<HalfSpace> region;  ///< the places inside the body that are nearest to this face
    std::vector<int> corners;       ///< of the face, as indices
    coupling::Box box;              ///< around them [m]
    double area = 0;                ///< of the face [m^2]
  };
  std::vector<Face> faces;
  std::vector<coupling::Vec3> corners;  ///< [m]
  coupling::Box box;                    ///< around them [m]
  double reach = 0;                     ///< radius of the sphere about the origin that holds the body [m]
  double thickness = 0;                 ///< twice the greatest depth inside [m]
};

/// The box around what `place` makes of some things; there must be one.
template <typename Things, typename Place = std::identity>
coupling::Box box_around(const Things& things, const Place& place = {}) {
  coupling::Box box{place(things.front()), place(things.front())};
  for (const auto& thing : things) {
    box.lower = box.lower.cwiseMin(place(thing));
    box.upper = box.upper.cwiseMax(place(thing));
  }
  return box;
}

/// Flat sides that stand for a cylinder's mantle.
inline constexpr int cylinder_sides = 48;

/// The faces of a shape. The mantle of a cylinder becomes flat sides of the same cross-section area. Throws InputError
/// for a sphere and for a shape that is not convex; `where` begins the message.
ConvexShape convex_shape(const coupling::Shape& shape, const std::string& where);

}  // namespace embacle::liggghts
