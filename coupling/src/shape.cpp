// Mass properties, bounding radius, surface area and signed distance of the shapes: closed formulas.
#include "embacle/coupling/shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  }
  return 0.0;
}

}  // namespace embacle::coupling
