// Where two bodies, or a body and a wall, overlap, and how hard they press there without damping. No LIGGGHTS here.
#pragma once

#include <vector>

#include "contact/convex_shape.hpp"

namespace embacle::liggghts {

/// A convex shape in its place.
struct PosedShape {
  const ConvexShape* shape = nullptr;
  coupling::Mat3 axes = coupling::Mat3::Identity();  ///< body frame to global frame
  coupling::Vec3 position = coupling::Vec3::Zero();  ///< of the centre of mass, relative to an origin of choice [m]
  double hardness = 0;                               ///< pressure per depth below the surface [Pa/m]

  [[nodiscard]] coupling::Vec3 to_global(const coupling::Vec3& x) const { return position + axes * x; }
  [[nodiscard]] HalfSpace to_global(const HalfSpace& half_space) const {
    const coupling::Vec3 normal = axes * half_space.normal;
    return {normal, half_space.offset + normal.dot(position)};
  }
};

/// The surface on which two bodies press each other, in places of a quadrature rule.
///
/// Pressure in a body is its hardness times the depth below its nearest face, and both bodies have the same pressure on
/// the patch (pressure-field contact: Elandt, Drumwright, Sherman & Ruina 2019, doi:10.1109/IROS40897.2019.8968548).
/// The force on either body is the gradient of the potential U = integral over the overlap of the smaller of both
/// pressures, so that an undamped contact keeps energy; it depends on the shapes alone, not on spheres that cover them.
/// A wall is a body that does not yield: U = integral of the body's pressure over its part beyond the wall.
struct Patch {
  struct Place {
    coupling::Vec3 position;  ///< relative to the origin of choice [m]
    coupling::Vec3 force;     ///< on the first body, of its share of the area [N]
    double size;              ///< of the force [N]
  };
  std::vector<Place> places;
  double stiffness = 0;  ///< of all springs side by side [N/m]
  double highest = 0;    ///< pressure at any place [Pa]
  double spread = 0;     ///< integral of the pressure times the squared distance from the origin of choice [N m^2]

  [[nodiscard]] bool empty() const { return places.empty(); }
  void clear() {
    places.clear();
    stiffness = 0;
    highest = 0;
    spread = 0;
  }
};

/// Adds the patch between two bodies that overlap, with the overlap that separation() found.
void press(const PosedShape& first, const PosedShape& second, double overlap, Patch& patch);
/// Adds the patch of a body on a plane through `point` with the unit normal towards the free side.
void press_plane(const PosedShape& body, const coupling::Vec3& point, const coupling::Vec3& normal, Patch& patch);
/// Likewise on a triangle; its solid side is where `normal` does not point.
void press_triangle(const PosedShape& body, const coupling::Triangle& triangle, const coupling::Vec3& normal,
                    Patch& patch);

/// A lower bound of the distance [m] between two bodies: the largest distance by which a face of one separates the
/// other; negative if they may overlap: then no place of the overlap is deeper below the surface of that one than this.
double separation(const PosedShape& first, const PosedShape& second);
/// Likewise for a triangle.
double separation_from_triangle(const PosedShape& body, const coupling::Triangle& triangle);
/// Distance [m] of the nearest corner from a plane, negative beyond it.
double separation_from_plane(const PosedShape& body, const coupling::Vec3& point, const coupling::Vec3& normal);

}  // namespace embacle::liggghts
