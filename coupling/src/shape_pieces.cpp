// The faces of a shape in parts: those that belong to the fluid's points, and small ones for sums over the surface.
#include "shape_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace embacle::coupling {

using std::numbers::pi;

namespace {

/// The directions of the faces that share a point, in its normal: across a box's axes, or of a cylinder around and
/// along its axis. The normal is their sum by area, scaled to one.
std::vector<Vec3> face_parts(const Shape& shape, const Vec3& normal) {
  if (shape.kind == ShapeKind::sphere) return {normal};
  if (shape.kind == ShapeKind::cylinder) return {Vec3(normal.x(), normal.y(), 0), Vec3(0, 0, normal.z())};
  return {Vec3(normal.x(), 0, 0), Vec3(0, normal.y(), 0), Vec3(0, 0, normal.z())};
}

/// The place on the face with this outward normal that a point below it belongs to.
Vec3 on_face(const Shape& shape, const Vec3& point, const Vec3& normal) {
  const bool end = shape.kind == ShapeKind::box || (shape.kind == ShapeKind::cylinder && std::abs(normal.z()) > 0.5);
  double depth = 0;
  if (end) {
    const Vec3 half = 0.5 * (shape.kind == ShapeKind::box ? shape.size : Vec3(0, 0, shape.size.y()));
    depth = normal.cwiseAbs().dot(half) - normal.dot(point);
  } else {
    depth = shape.size.x() - normal.dot(point);
  }
  return point + depth * normal;
}

int parts_of(double length, double spacing) { return std::max(1, static_cast<int>(std::ceil(length / spacing))); }

using Visit = std::function<void(const Vec3&, const Vec3&)>;

void visit_box(const Vec3& size, double spacing, const Visit& visit) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int nu = parts_of(size[u], spacing), nv = parts_of(size[v], spacing);
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        for (const int side : {-1, 1}) {
          Vec3 place = 0.5 * side * size[axis] * Vec3::Unit(axis);
          place[u] = ((i + 0.5) / nu - 0.5) * size[u];
          place[v] = ((j + 0.5) / nv - 0.5) * size[v];
          visit(place, side * size[u] * size[v] / (nu * nv) * Vec3::Unit(axis));
        }
      }
    }
  }
}

void visit_corners(const Vec3& size, const Visit& visit) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 side((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    visit(0.5 * size.cwiseProduct(side), Vec3::Zero());
  }
}

void visit_sphere(double radius, double spacing, const Visit& visit) {
  const int zones = parts_of(pi * radius, spacing);
  for (int k = 0; k < zones; ++k) {
    const double from = std::cos(pi * k / zones), to = std::cos(pi * (k + 1) / zones);
    const double z = 0.5 * (from + to), around = std::sqrt(1 - z * z);
    const int count = parts_of(2 * pi * around * radius, spacing);
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * pi * (i + 0.5) / count;
      const Vec3 normal(around * std::cos(angle), around * std::sin(angle), z);
      visit(radius * normal, 2 * pi * radius * radius * (from - to) / count * normal);
    }
  }
}

void visit_cylinder(double radius, double length, double spacing, const Visit& visit) {
  const int count = parts_of(2 * pi * radius, spacing), planes = parts_of(length, spacing);
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * pi * (i + 0.5) / count;
    const Vec3 normal(std::cos(angle), std::sin(angle), 0);
    for (int k = 0; k < planes; ++k) {
      visit(radius * normal + ((k + 0.5) / planes - 0.5) * length * Vec3::UnitZ(),
            2 * pi * radius * length / (count * planes) * normal);
    }
    for (const double z : {-0.5 * length, 0.5 * length}) visit(radius * normal + z * Vec3::UnitZ(), Vec3::Zero());
  }
  const int rings = parts_of(radius, spacing);
  for (int ring = 0; ring < rings; ++ring) {
    const double inner = radius * ring / rings, outer = radius * (ring + 1) / rings;
    const int around = parts_of(2 * pi * outer, spacing);
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * (i + 0.5) / around, r = 0.5 * (inner + outer);
      for (const int side : {-1, 1}) {
        visit(Vec3(r * std::cos(angle), r * std::sin(angle), 0.5 * side * length),
              side * pi * (outer * outer - inner * inner) / around * Vec3::UnitZ());
      }
    }
  }
}

}  // namespace

std::vector<SurfacePiece> pieces_of_points(const Shape& shape, const std::vector<ShapePoint>& points) {
  std::vector<SurfacePiece> pieces;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ShapePoint& point = points[k];
    const std::vector<Vec3> parts = face_parts(shape, point.normal);
    double sum = 0;
    for (const Vec3& part : parts) sum += part.norm();
    for (const Vec3& part : parts) {
      if (!point.on_surface() || part.norm() < 1e-9) continue;
      pieces.push_back(
          {static_cast<int>(k), on_face(shape, point.position, part.normalized()), point.area / sum * part});
    }
  }
  return pieces;
}

void Shape::visit_surface(double spacing, const Visit& visit) const {
  switch (kind) {
    case ShapeKind::box:
      visit_box(size, spacing, visit);
      return visit_corners(size, visit);
    case ShapeKind::sphere:
      return visit_sphere(size.x(), spacing, visit);
    case ShapeKind::cylinder:
      return visit_cylinder(size.x(), size.y(), spacing, visit);
    case ShapeKind::prism:
    case ShapeKind::surface:
      for (const Triangle& triangle : polyhedron->surface.triangles()) divide(triangle, spacing, visit);
      for (const Vec3& corner : polyhedron->surface.sharp_corners()) visit(corner, Vec3::Zero());
  }
}

}  // namespace embacle::coupling
