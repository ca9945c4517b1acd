#include "core/surface_loads.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::mps {

using coupling::Load;
using coupling::Shape;
using coupling::SurfacePiece;
using coupling::Vec3;

SurfaceLoads::SurfaceLoads(const Constants& constants, const Bodies& bodies, int first_owner)
    : constants_(constants),
      first_owner_(first_owner),
      thickness_(constants.dimension == 2
                     ? constants.particle_mass / (constants.density * std::pow(constants.particle_distance, 2))
                     : 1.0) {
  for (const Shape& shape : bodies.shapes()) {
    ShapePieces& result = shapes_.emplace_back();
    result.first.push_back(0);
    std::vector<SurfacePiece> pieces;
    const std::size_t points = shape
                                   .points(constants.particle_distance, constants.layers * constants.particle_distance,
                                           constants.dimension, &pieces)
                                   .size();
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const SurfacePiece& a, const SurfacePiece& b) { return a.point < b.point; });
    for (int k = 0; k < static_cast<int>(points); ++k) {
      for (std::size_t n = result.pieces.size(); n < pieces.size() && pieces[n].point == k; ++n) {
        result.pieces.push_back({pieces[n].place, thickness_ * pieces[n].area});
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
