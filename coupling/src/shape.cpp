// Mass properties, bounding radius, surface area and signed distance of the shapes: closed formulas.
#include "embacle/coupling/shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "polygon.hpp"

namespace embacle::coupling {

using std::numbers::pi;

MassProperties Shape::mass_properties() const {
  MassProperties result;
  switch (kind) {
    case ShapeKind::box: {
      result.volume = size.prod();
      result.mass = density * result.volume;
      const Vec3 squared = size.cwiseAbs2();
      result.inertia = result.mass / 12.0 * (Vec3::Constant(squared.sum()) - squared);
      break;
    }
    case ShapeKind::sphere: {
      const double radius = size.x();
      result.volume = 4.0 / 3.0 * pi * radius * radius * radius;
      result.mass = density * result.volume;
      result.inertia = Vec3::Constant(0.4 * result.mass * radius * radius);
      break;
    }
    case ShapeKind::cylinder: {
      const double radius = size.x();
      const double length = size.y();
      result.volume = pi * radius * radius * length;
      result.mass = density * result.volume;
      const double across = result.mass * (3.0 * radius * radius + length * length) / 12.0;
      result.inertia = {across, across, 0.5 * result.mass * radius * radius};
      break;
    }
    case ShapeKind::prism:
    case ShapeKind::surface:
      result.volume = polyhedron->volume;
      result.mass = density * result.volume;
      result.inertia = density * polyhedron->inertia;
      break;
  }
  return result;
}

double Shape::bounding_radius() const {
  switch (kind) {
    case ShapeKind::box:
      return 0.5 * size.norm();
    case ShapeKind::sphere:
      return size.x();
    case ShapeKind::cylinder:
      return std::hypot(size.x(), 0.5 * size.y());
    case ShapeKind::prism:
    case ShapeKind::surface: {
      double farthest = 0;
      for (const Triangle& triangle : polyhedron->surface.triangles()) {
        for (const Vec3& corner : triangle) farthest = std::max(farthest, corner.norm());
      }
      return farthest;
    }
  }
  return 0.0;
}

double Shape::surface_area() const {
  switch (kind) {
    case ShapeKind::box:
      return 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
    case ShapeKind::sphere:
      return 4.0 * pi * size.x() * size.x();
    case ShapeKind::cylinder:
      return 2.0 * pi * size.x() * (size.x() + size.y());
    case ShapeKind::prism:
    case ShapeKind::surface:
      return polyhedron->surface.area();
  }
  return 0.0;
}

double Shape::signed_distance(const Vec3& point) const {
  // Outside: the distance to the nearest face, edge or corner; inside: minus the distance to the nearest face.
  const auto extruded = [](const auto& excess) {
    return excess.cwiseMax(0.0).norm() + std::min(0.0, excess.maxCoeff());
  };
  switch (kind) {
    case ShapeKind::box:
      return extruded(Vec3(point.cwiseAbs() - 0.5 * size));
    case ShapeKind::sphere:
      return point.norm() - size.x();
    case ShapeKind::cylinder:
      return extruded(Eigen::Vector2d(point.head<2>().norm() - size.x(), std::abs(point.z()) - 0.5 * size.y()));
    case ShapeKind::prism:
      return extruded(
          Vec2(polygon_distance(polyhedron->polygon, point.head<2>()), std::abs(point.z()) - 0.5 * size.z()));
    case ShapeKind::surface:
      return polyhedron->surface.distance(point);
  }
  return 0.0;
}

Box Shape::extents(const Quaternion& orientation) const {
  const Mat3 axes = orientation.toRotationMatrix();
  Vec3 half = Vec3::Zero();
  switch (kind) {
    case ShapeKind::box:
      half = axes.cwiseAbs() * (0.5 * size);
      break;
    case ShapeKind::sphere:
      half = Vec3::Constant(size.x());
      break;
    case ShapeKind::cylinder: {
      const Vec3 axis = axes.col(2);
      const Vec3 disc = (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt() * size.x();
      half = disc + axis.cwiseAbs() * (0.5 * size.y());
      break;
    }
    case ShapeKind::prism:
    case ShapeKind::surface: {
      Box box;  // the centre of mass may lie outside the shape, but not outside this box
      for (const Triangle& triangle : polyhedron->surface.triangles()) {
        for (const Vec3& corner : triangle) {
          box.lower = box.lower.cwiseMin(axes * corner);
          box.upper = box.upper.cwiseMax(axes * corner);
        }
      }
      return box;
    }
  }
  return {-half, half};
}

double Shape::inscribed_radius() const {
  switch (kind) {
    case ShapeKind::box:
      return 0.5 * size.minCoeff();
    case ShapeKind::sphere:
      return size.x();
    case ShapeKind::cylinder:
      return std::min(size.x(), 0.5 * size.y());
    case ShapeKind::prism:
    case ShapeKind::surface:
      break;
  }
  // The deepest place of a lattice, then a compass search, whose step halves where no direction leads deeper by a part
  // of the step: along a ridge it would creep for ever.
  const Box& box = polyhedron->surface.bounds();
  constexpr int cells = 12;
  const double edge = size.maxCoeff() / cells;
  Vec3 deepest = Vec3::Zero();
  double depth = 0;
  const Eigen::Vector3i count = (size / edge).cast<int>() + Eigen::Vector3i::Ones();
  for (int i = 0; i < count.x(); ++i) {
    for (int j = 0; j < count.y(); ++j) {
      for (int k = 0; k < count.z(); ++k) {
        const Vec3 share = (Vec3(i, j, k).array() + 0.5) / count.cast<double>().array();
        const Vec3 place = box.lower + share.cwiseProduct(size);
        const double below = -signed_distance(place);
        if (below <= depth) continue;
        depth = below;
        deepest = place;
      }
    }
  }
  for (double step = edge; step > 1e-12 * size.maxCoeff();) {
    bool moved = false;
    for (int direction = 0; direction < 26; ++direction) {
      const int code = direction < 13 ? direction : direction + 1;  // 13 is no direction
      const Eigen::Vector3i way(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
      const Vec3 place = deepest + step * way.cast<double>();
      const double below = -signed_distance(place);
      if (below <= depth + 0.01 * step) continue;
      depth = below;
      deepest = place;
      moved = true;
    }
    if (!moved) step *= 0.5;
  }
  return depth;
}

}  // namespace embacle::coupling
