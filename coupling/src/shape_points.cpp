// Boundary points of the shapes: layers parallel to the surface, the outermost inset by half a layer.
//
// A box is filled with cells of (nearly) equal edges; a cylinder with concentric rings in plane layers; a sphere with
// concentric shells of latitude rings. The faces are divided among the points of the outermost layer exactly, so that
// areas sum to the shape's area and area times normal sums to zero.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "embacle/coupling/shape.hpp"
#include "polyhedron.hpp"
#include "shape_pieces.hpp"

namespace embacle::coupling {

using std::numbers::pi;

namespace {

/// Number of layers of about `spacing` that fill `length`.
int layers_in(double length, double spacing) { return std::max(1, static_cast<int>(std::lround(length / spacing))); }

/// Adds the part `area` of a face with the given normal to a point; normals are area-weighted until `finish`.
void add_face(ShapePoint& point, const Vec3& normal, double area) {
  point.area += area;
  point.normal += area * normal;
}

/// Makes the normal a unit vector. It stays zero where opposite faces share the point (a plate one layer thick).
void finish(ShapePoint& point) {
  const double length = point.normal.norm();
  point.normal = length > 1e-9 * point.area ? Vec3(point.normal / length) : Vec3::Zero();
}

/// Distance from the centre of cell `index` (of `count` cells along an edge) to the nearer end of the edge.
double depth_below_ends(int index, int count, double cell) { return (std::min(index, count - 1 - index) + 0.5) * cell; }

/// Collects points, leaving out what is deeper than the fluid can feel.
class Collector {
 public:
  Collector(double depth, double spacing) : depth_(depth + 1e-9 * spacing) {}

  [[nodiscard]] bool keeps(double depth_below_surface) const { return depth_below_surface <= depth_; }
  void add(ShapePoint point) {
    finish(point);
    points_.push_back(point);
  }
  std::vector<ShapePoint> take() { return std::move(points_); }

 private:
  double depth_;
  std::vector<ShapePoint> points_;
};

std::vector<ShapePoint> box_points(const Vec3& size, double spacing, double depth, int dimension) {
  std::array<int, 3> count{1, 1, 1};
  Vec3 cell = Vec3::Ones();  // in two dimensions the slice has unit thickness, so that areas are lengths
  for (int axis = 0; axis < dimension; ++axis) {
    count[axis] = layers_in(size[axis], spacing);
    cell[axis] = size[axis] / count[axis];
  }
  Collector collector(depth, spacing);
  const auto add = [&](const std::array<int, 3>& index) {
    ShapePoint point{.position = Vec3::Zero()};
    for (int axis = 0; axis < dimension; ++axis) {
      point.position[axis] = (index[axis] + 0.5) * cell[axis] - 0.5 * size[axis];
      const double face = cell.prod() / cell[axis];
      if (index[axis] == 0) add_face(point, -Vec3::Unit(axis), face);
      if (index[axis] == count[axis] - 1) add_face(point, Vec3::Unit(axis), face);
    }
    collector.add(point);
  };
  const auto in_shell = [&](int axis, int index) {
    const bool outermost = index == 0 || index == count[axis] - 1;
    return axis < dimension && (outermost || collector.keeps(depth_below_ends(index, count[axis], cell[axis])));
  };
  int layers_z = 0;  // layers along z that belong to the shell below each of the two faces
  while (layers_z < count[2] && in_shell(2, layers_z)) ++layers_z;
  for (int i = 0; i < count[0]; ++i) {
    for (int j = 0; j < count[1]; ++j) {
      const bool whole_row = in_shell(0, i) || in_shell(1, j);
      for (int k = 0; k < count[2]; ++k) {
        const bool inside = !whole_row && k >= layers_z && k < count[2] - layers_z;
        if (inside) {
          k = count[2] - layers_z - 1;  // the inside of a large box costs nothing
        } else {
          add({i, j, k});
        }
      }
    }
  }
  return collector.take();
}

/// Positions on a circle of the radius about z, nearly `spacing` apart; every second ring is turned by half a step.
std::vector<Vec3> ring(double radius, double spacing, bool turned, int at_least) {
  const int count = std::max(at_least, static_cast<int>(std::lround(2.0 * pi * radius / spacing)));
  std::vector<Vec3> positions;
  positions.reserve(count);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * pi * (i + (turned ? 0.5 : 0.0)) / count;
    positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  return positions;
}

/// Rings in `layers` planes along z; `layers` 0 is the two-dimensional slice, a circle of unit thickness.
std::vector<ShapePoint> cylinder_points(double radius, double length, double spacing, double depth, int layers) {
  const bool slice = layers == 0;
  const int planes = std::max(1, layers);
  const double height = slice ? 1.0 : length / planes;
  const int rings = layers_in(radius, spacing);
  const double width = radius / rings;
  Collector collector(depth, spacing);
  for (int plane = 0; plane < planes; ++plane) {
    const bool bottom = !slice && plane == 0;
    const bool top = !slice && plane == planes - 1;
    const double below_end = slice ? std::numeric_limits<double>::infinity() : depth_below_ends(plane, planes, height);
    const double z = slice ? 0.0 : (plane + 0.5) * height - 0.5 * length;
    for (int k = 0; k < rings; ++k) {
      const double r = radius - (k + 0.5) * width;
      const bool outermost = k == 0;
      if (!(outermost || bottom || top || collector.keeps(std::min(below_end, radius - r)))) continue;
      const std::vector<Vec3> positions = ring(r, width, k % 2 == 1, 3);
      const double share = 1.0 / static_cast<double>(positions.size());
      for (const Vec3& position : positions) {
        ShapePoint point{.position = position + Vec3(0, 0, z)};
        if (outermost) add_face(point, position / r, 2.0 * pi * radius * height * share);
        if (bottom) add_face(point, -Vec3::UnitZ(), 2.0 * pi * r * width * share);
        if (top) add_face(point, Vec3::UnitZ(), 2.0 * pi * r * width * share);
        collector.add(point);
      }
    }
  }
  return collector.take();
}

std::vector<ShapePoint> sphere_points(double radius, double spacing, double depth) {
  const int shells = layers_in(radius, spacing);
  const double width = radius / shells;
  Collector collector(depth, spacing);
  for (int shell = 0; shell < shells; ++shell) {
    const double r = radius - (shell + 0.5) * width;
    if (shell > 0 && !collector.keeps(radius - r)) break;
    const int rings = std::max(2, static_cast<int>(std::lround(pi * r / width)));
    for (int k = 0; k < rings; ++k) {
      const double polar = pi * (k + 0.5) / rings;
      const std::vector<Vec3> positions = ring(r * std::sin(polar), width, k % 2 == 1, 2);
      const double zone = 2.0 * pi * radius * radius * (std::cos(pi * k / rings) - std::cos(pi * (k + 1) / rings));
      for (const Vec3& position : positions) {
        ShapePoint point{.position = position + Vec3(0, 0, r * std::cos(polar))};
        if (shell == 0) add_face(point, point.position / r, zone / static_cast<double>(positions.size()));
        collector.add(point);
      }
    }
  }
  return collector.take();
}

}  // namespace

std::vector<ShapePoint> Shape::points(double spacing, double depth, int dimension,
                                      std::vector<SurfacePiece>* pieces) const {
  if (!(spacing > 0) || (dimension != 2 && dimension != 3)) {
    throw InputError(fmt::format("shape '{}': points need a spacing > 0 and dimension 2 or 3, not {} m and {}", name,
                                 spacing, dimension));
  }
  std::vector<ShapePoint> points;
  switch (kind) {
    case ShapeKind::box:
      points = box_points(size, spacing, depth, dimension);
      break;
    case ShapeKind::sphere:
      points =
          dimension == 2 ? cylinder_points(size.x(), 0.0, spacing, depth, 0) : sphere_points(size.x(), spacing, depth);
      break;
    case ShapeKind::cylinder: {
      const int layers = dimension == 2 ? 0 : layers_in(size.y(), spacing);
      points = cylinder_points(size.x(), size.y(), spacing, depth, layers);
      break;
    }
    case ShapeKind::prism:
    case ShapeKind::surface: {
      if (dimension == 2 && kind == ShapeKind::surface) {
        throw InputError(
            fmt::format("shape '{}': solids of triangles are not for two-dimensional water; bodies are "
                        "boxes, prisms or cylinders there",
                        name));
      }
      std::vector<SurfacePiece> own;
      points = polyhedron_points(*this, spacing, depth, dimension, own);
      for (const SurfacePiece& piece : own) {
        const double area = piece.area.norm();
        add_face(points[piece.point], piece.area / area, area);
      }
      for (ShapePoint& point : points) finish(point);
      if (pieces != nullptr) *pieces = std::move(own);
      return points;
    }
  }
  if (pieces != nullptr) *pieces = pieces_of_points(*this, points);
  return points;
}

}  // namespace embacle::coupling
