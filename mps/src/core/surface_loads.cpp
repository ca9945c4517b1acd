#include "core/surface_loads.hpp"

#include <cmath>

namespace embacle::mps {

using coupling::Load;
using coupling::Shape;
using coupling::ShapeKind;
using coupling::ShapePoint;
using coupling::Vec3;

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

}  // namespace

SurfaceLoads::SurfaceLoads(const Constants& constants, const Bodies& bodies, int first_owner)
    : constants_(constants),
      first_owner_(first_owner),
      thickness_(constants.dimension == 2
                     ? constants.particle_mass / (constants.density * std::pow(constants.particle_distance, 2))
                     : 1.0) {
  for (const Shape& shape : bodies.shapes()) {
    ShapePieces& result = shapes_.emplace_back();
    result.first.push_back(0);
    for (const ShapePoint& point : shape.points(constants.particle_distance,
                                                constants.layers * constants.particle_distance, constants.dimension)) {
      const std::vector<Vec3> parts = face_parts(shape, point.normal);
      double sum = 0;
      for (const Vec3& part : parts) sum += part.norm();
      for (const Vec3& part : parts) {
        if (!point.on_surface() || part.norm() < 1e-9) continue;
        const Vec3 area = thickness_ * point.area / sum * part;
        result.pieces.push_back({on_face(shape, point.position, part.normalized()), area});
      }
      result.first.push_back(result.pieces.size());
    }
  }
}

std::vector<Load> SurfaceLoads::partial_loads(const Particles& particles, const Bodies& bodies) const {
  std::vector<Load> loads(bodies.count());
  const Vec3 gravity(constants_.static_gravity[0], constants_.static_gravity[1], constants_.static_gravity[2]);
  for (std::size_t j = particles.water; j < particles.own(); ++j) {
    const Identity& identity = particles.identity[j];
    const Record& point = particles.record[j];
    if (identity.owner < first_owner_ || point.p <= 0) continue;
    const auto b = static_cast<std::size_t>(identity.owner - first_owner_);
    const coupling::FluidBody& body = bodies.all()[b];
    const ShapePieces& shape = shapes_[body.shape];
    const Vec3 slope = constants_.density * (gravity - bodies.acceleration(b));
    for (std::size_t k = shape.first[identity.point]; k < shape.first[identity.point + 1]; ++k) {
      const Vec3 arm = body.state.orientation * shape.pieces[k].place;
      const Vec3 from_point = body.state.position + arm - Vec3(point.x[0], point.x[1], point.x[2]);
      const Vec3 force = -(point.p + slope.dot(from_point)) * (body.state.orientation * shape.pieces[k].area);
      loads[b].force += force;
      loads[b].torque += arm.cross(force);
    }
  }
  return loads;
}

}  // namespace embacle::mps
