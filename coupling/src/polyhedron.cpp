// Prisms and solids of triangles: their body frame, and the points by which the fluid sees them.
#include "polyhedron.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "cells.hpp"
#include "embacle/coupling/layers.hpp"
#include "polygon.hpp"

namespace embacle::coupling {

namespace {

std::vector<Triangle> extrude(const std::vector<Vec2>& polygon, double length) {
  const std::size_t n = polygon.size();
  const auto at = [&](std::size_t k, double z) { return Vec3(polygon[k % n].x(), polygon[k % n].y(), z); };
  const double low = -0.5 * length, high = 0.5 * length;
  std::vector<Triangle> result;
  for (std::size_t k = 0; k < n; ++k) {
    result.push_back({at(k, low), at(k + 1, low), at(k + 1, high)});
    result.push_back({at(k, low), at(k + 1, high), at(k, high)});
  }
  for (const auto& [a, b, c] : triangulate(polygon)) {
    result.push_back({at(a, high), at(b, high), at(c, high)});
    result.push_back({at(a, low), at(c, low), at(b, low)});
  }
  return result;
}

/// Number of layers of about `spacing` that fill `length`.
int layers_in(double length, double spacing) { return std::max(1, static_cast<int>(std::lround(length / spacing))); }

/// Edges of cells of about `spacing` that fill the box.
Vec3 even_cell(const Box& box, double spacing) {
  Vec3 cell = box.upper - box.lower;
  for (int c = 0; c < 3; ++c) {
    if (cell[c] > 0) cell[c] /= layers_in(cell[c], spacing);
  }
  return cell;
}

/// Points of the polygon down to `depth`, in layers.
std::vector<LayerPoint> polygon_points(const std::vector<Vec2>& polygon, double spacing, double depth) {
  Box box{Vec3::Constant(std::numeric_limits<double>::max()), Vec3::Constant(std::numeric_limits<double>::lowest())};
  for (const Vec2& corner : polygon) {
    box.lower.head<2>() = box.lower.head<2>().cwiseMin(corner);
    box.upper.head<2>() = box.upper.head<2>().cwiseMax(corner);
  }
  box.lower.z() = box.upper.z() = 0;
  const auto distance = [&](const Vec3& place, Vec3& normal) {
    Vec2 flat;
    const double result = polygon_distance(polygon, place.head<2>(), &flat);
    normal = Vec3(flat.x(), flat.y(), 0);
    return result;
  };
  std::vector<LayerPoint> points = layer_points(box, even_cell(box, spacing), 2, spacing, depth, distance, true);
  even_out(points, 2, spacing, distance);
  return points;
}

/// Shares the faces among the points: each small part belongs to the nearest of the outermost points. Parts of one face
/// and one point are joined into a piece.
class Sharing {
 public:
  Sharing(const std::vector<ShapePoint>& points, const std::vector<bool>& outermost, double spacing)
      : points_(points), reach_(2 * spacing), cells_(reach_), outermost_(outermost) {
    for (const ShapePoint& point : points) cells_.add(point.position);
  }

  void add(const Vec3& place, const Vec3& area) {
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](std::size_t k) {
      const double square = (points_[k].position - place).squaredNorm();
      if (!outermost_[k] || square >= least) return;
      least = square;
      nearest = static_cast<int>(k);
    };
    cells_.visit(place, reach_, consider);
    if (nearest < 0) {
      for (std::size_t k = 0; k < points_.size(); ++k) consider(k);
    }
    SurfacePiece& piece = face_.try_emplace(nearest, SurfacePiece{nearest, Vec3::Zero(), Vec3::Zero()}).first->second;
    piece.place += area.norm() * place;
    piece.area += area;
  }

  void finish_face() {
    for (auto& [point, piece] : face_) {
      piece.place /= piece.area.norm();
      pieces_.push_back(piece);
    }
    face_.clear();
  }

  std::vector<SurfacePiece> take() { return std::move(pieces_); }

 private:
  const std::vector<ShapePoint>& points_;
  double reach_;
  Cells cells_;
  const std::vector<bool>& outermost_;
  std::map<int, SurfacePiece> face_;
  std::vector<SurfacePiece> pieces_;
};

}  // namespace

std::shared_ptr<const Polyhedron> make_polyhedron(std::vector<Triangle> triangles, std::vector<Vec2> polygon) {
  const SolidMoments moments = solid_moments(triangles);
  return std::make_shared<Polyhedron>(
      Polyhedron{ClosedSurface(std::move(triangles)), moments.volume, moments.inertia.diagonal(), std::move(polygon)});
}

Shape make_solid(const std::vector<Triangle>& triangles, double density) {
  if (triangles.empty()) throw InputError("a solid needs triangles");
  const SolidMoments moments = solid_moments(triangles);
  if (!(moments.volume > 0)) throw InputError(fmt::format("the surface encloses a volume of {} m3", moments.volume));
  Shape shape;
  shape.kind = ShapeKind::surface;
  shape.density = density;
  shape.given_centre = moments.centre;
  const Mat3 axes = principal_axes(moments.inertia);
  shape.given_axes = Quaternion(axes);
  std::vector<Triangle> own = triangles;
  for (Triangle& triangle : own) {
    for (Vec3& corner : triangle) corner = axes.transpose() * (corner - moments.centre);
  }
  shape.polyhedron = make_polyhedron(std::move(own), {});
  const Box& box = shape.polyhedron->surface.bounds();
  shape.size = box.upper - box.lower;
  return shape;
}

Shape make_prism(const std::vector<Vec2>& corners, double length, double density) {
  if (!(length > 0)) throw InputError(fmt::format("the length of a prism must be greater than zero, not {}", length));
  const std::vector<Vec2> polygon = checked_polygon(corners);
  Shape shape = make_solid(extrude(polygon, length), density);
  shape.kind = ShapeKind::prism;
  shape.given_centre.z() = 0;
  // Its axis is a principal one, so the body frame is turned about it only.
  std::vector<Vec2> own;
  for (const Vec2& corner : polygon) {
    const Vec3 given(corner.x(), corner.y(), shape.given_centre.z());
    own.emplace_back((shape.given_axes.conjugate() * (given - shape.given_centre)).head<2>());
  }
  shape.polyhedron = make_polyhedron(extrude(own, length), own);
  const Box& box = shape.polyhedron->surface.bounds();
  shape.size = box.upper - box.lower;
  return shape;
}

std::vector<ShapePoint> polyhedron_points(const Shape& shape, double spacing, double depth, int dimension,
                                          std::vector<SurfacePiece>& pieces) {
  const Polyhedron& body = *shape.polyhedron;
  const double with_tolerance = depth + 1e-9 * spacing;
  std::vector<ShapePoint> points;
  std::vector<bool> outermost;
  const auto add = [&](const Vec3& place, bool outer) {
    points.push_back({.position = place});
    outermost.push_back(outer);
  };
  if (shape.kind == ShapeKind::prism) {
    const int planes = dimension == 2 ? 1 : layers_in(shape.size.z(), spacing);
    const double height = shape.size.z() / planes;
    const double everywhere = std::numeric_limits<double>::infinity();
    const auto section =
        polygon_points(body.polygon, spacing, dimension == 2 ? std::max(with_tolerance, spacing) : everywhere);
    for (int plane = 0; plane < planes; ++plane) {
      const int from_end = std::min(plane, planes - 1 - plane);
      const double below_end = dimension == 2 ? everywhere : (from_end + 0.5) * height;
      const bool at_end = dimension == 3 && from_end == 0;
      for (const LayerPoint& point : section) {
        const bool outer = point.layer == 0 || at_end;
        if (!outer && std::min(below_end, (point.layer + 0.5) * spacing) > with_tolerance) continue;
        const double z = dimension == 2 ? 0.0 : (plane + 0.5) * height - 0.5 * shape.size.z();
        add(point.position + Vec3(0, 0, z), outer);
      }
    }
  } else {
    const auto distance = [&](const Vec3& place, Vec3& normal) { return body.surface.distance(place, &normal); };
    const Box& box = body.surface.bounds();
    auto layers =
        layer_points(box, even_cell(box, spacing), 3, spacing, std::max(with_tolerance, spacing), distance, true);
    even_out(layers, 3, spacing, distance);
    for (const LayerPoint& point : layers) add(point.position, point.layer == 0);
  }
  if (std::find(outermost.begin(), outermost.end(), true) == outermost.end()) {
    throw InputError(
        fmt::format("shape '{}' has no room for points that are {} m apart; choose a smaller particle distance",
                    shape.name, spacing));
  }
  Sharing sharing(points, outermost, spacing);
  if (dimension == 2) {
    for (std::size_t k = 0; k < body.polygon.size(); ++k) {
      const Vec2 &a = body.polygon[k], &b = body.polygon[(k + 1) % body.polygon.size()];
      const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (0.1 * spacing))));
      const Vec2 along = (b - a) / parts;
      for (int part = 0; part < parts; ++part) {
        const Vec2 place = a + (part + 0.5) * along;
        sharing.add(Vec3(place.x(), place.y(), 0), Vec3(along.y(), -along.x(), 0));
      }
      sharing.finish_face();
    }
  } else {
    for (const Triangle& triangle : body.surface.triangles()) {
      divide(triangle, spacing / 3, [&](const Vec3& place, const Vec3& area) { sharing.add(place, area); });
      sharing.finish_face();
    }
  }
  pieces = sharing.take();
  return points;
}

}  // namespace embacle::coupling
