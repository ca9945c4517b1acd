#include "contact/convex_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace embacle::liggghts {

using coupling::Vec3;

namespace {

/// The outer half-spaces of a shape, each once.
std::vector<HalfSpace> outer_faces(const coupling::Shape& shape, const std::string& where) {
  std::vector<HalfSpace> faces;
  switch (shape.kind) {
    case coupling::ShapeKind::box:
      for (int k = 0; k < 3; ++k) {
        for (const double sign : {-1.0, 1.0}) faces.push_back({sign * Vec3::Unit(k), 0.5 * shape.size[k]});
      }
      break;
    case coupling::ShapeKind::cylinder: {
      const double step = 2 * std::numbers::pi / cylinder_sides;
      // A regular polygon of n sides at distance d from its centre has the area n d^2 tan(pi / n).
      const double distance =
          shape.size[0] * std::sqrt(std::numbers::pi / (cylinder_sides * std::tan(std::numbers::pi / cylinder_sides)));
      for (int s = 0; s < cylinder_sides; ++s) {
        faces.push_back({Vec3(std::cos(s * step), std::sin(s * step), 0), distance});
      }
      for (const double sign : {-1.0, 1.0}) faces.push_back({sign * Vec3::UnitZ(), 0.5 * shape.size[1]});
      break;
    }
    case coupling::ShapeKind::prism:
    case coupling::ShapeKind::surface: {
      const auto& triangles = shape.polyhedron->surface.triangles();
      const double close = 1e-6 * shape.bounding_radius();
      for (const auto& triangle : triangles) {
        const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
        const double offset = normal.dot(triangle[0]);
        for (const auto& other : triangles) {
          for (const Vec3& corner : other) {
            if (normal.dot(corner) > offset + close) {
              throw coupling::InputError(where + ": contacts of model floe need convex shapes, and '" + shape.name +
                                         "' is not convex; use several convex bodies, or model hertz");
            }
          }
        }
        const bool known = std::any_of(faces.begin(), faces.end(), [&](const HalfSpace& face) {
          return face.normal.dot(normal) > 1 - 1e-9 && std::abs(face.offset - offset) < close;
        });
        if (!known) faces.push_back({normal, offset});
      }
      break;
    }
    case coupling::ShapeKind::sphere:
      throw coupling::InputError(where + ": model floe has no spheres; use model hertz for '" + shape.name + "'");
  }
  return faces;
}

/// What is left of the plane of `bound` inside all other half-spaces of a region.
FlatPolygon piece_of(const std::vector<HalfSpace>& region, std::size_t bound, double reach) {
  FlatPolygon piece;
  const double length = region[bound].normal.norm();
  const Vec3 far = Vec3::Constant(2 * reach);
  bool left = piece.set(region[bound].normal / length, region[bound].offset / length, -far, far);
  for (std::size_t other = 0; left && other < region.size(); ++other) {
    if (other != bound) left = piece.cut(region[other]);
  }
  return piece;
}

}  // namespace

ConvexShape convex_shape(const coupling::Shape& shape, const std::string& where) {
  const std::vector<HalfSpace> outer = outer_faces(shape, where);
  ConvexShape result;
  result.reach = shape.bounding_radius();
  const double negligible = 1e-12 * result.reach * result.reach;
  for (std::size_t f = 0; f < outer.size(); ++f) {
    // Nearer to face f than to face g: offset_f - n_f . x <= offset_g - n_g . x.
    std::vector<HalfSpace> bounds = {outer[f]};
    for (std::size_t g = 0; g < outer.size(); ++g) {
      if (g != f) bounds.push_back({outer[g].normal - outer[f].normal, outer[g].offset - outer[f].offset});
    }
    ConvexShape::Face face;
    face.outside = outer[f];
    for (std::size_t b = 0; b < bounds.size(); ++b) {
      const FlatPolygon piece = piece_of(bounds, b, result.reach);
      const double area = piece.area();
      if (area <= negligible) continue;
      face.region.push_back(bounds[b]);
      for (std::size_t c = 0; c < piece.size(); ++c) {
        const Vec3 corner = piece.place(piece.corner(c));
        result.thickness = std::max(result.thickness, 2 * (face.outside.offset - face.outside.normal.dot(corner)));
        if (b > 0) continue;
        const auto known = std::find_if(result.corners.begin(), result.corners.end(), [&](const Vec3& other) {
          return (other - corner).norm() < 1e-9 * result.reach;
        });
        face.corners.push_back(static_cast<int>(known - result.corners.begin()));
        if (known == result.corners.end()) result.corners.push_back(corner);
      }
      if (b == 0) face.area = area;
    }
    if (face.area == 0) continue;  // touches the body at an edge or corner only
    face.box = box_around(face.corners, [&](int c) -> const Vec3& { return result.corners[c]; });
    result.faces.push_back(std::move(face));
  }
  result.box = box_around(result.corners);
  for (const Vec3& corner : result.corners) result.reach = std::max(result.reach, corner.norm());
  return result;
}

}  // namespace embacle::liggghts
