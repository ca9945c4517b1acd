#include "core/sponges.hpp"

#include <cmath>

#include "core/threads.hpp"

namespace embacle::mps {

double Sponges::damping_time(const Sponge& sponge, double gravity, int upright) {
  if (sponge.damping_time > 0) return sponge.damping_time;
  const int axis = axis_of(sponge.direction);
  const auto extent = [&](int c) { return sponge.region.upper[c] - sponge.region.lower[c]; };
  return extent(axis) / (12 * std::sqrt(gravity * extent(upright)));
}

Sponges::Sponges(const Scene& scene, const Constants& constants) : dimension_(constants.dimension) {
  const Vec3d& g = scene.fluid.gravity;
  for (const Sponge& sponge : scene.sponges) {
    const int axis = axis_of(sponge.direction);
    const bool forward = sign_of(sponge.direction) > 0;
    const double length = sponge.region.upper[axis] - sponge.region.lower[axis];
    zones_.push_back({.region = sponge.region,
                      .axis = axis,
                      .start = forward ? sponge.region.lower[axis] : sponge.region.upper[axis],
                      .per_length = (forward ? 1 : -1) / length,
                      .rate = 1 / damping_time(sponge, std::hypot(g[0], g[1], g[2]), scene.upright()),
                      .velocity = sponge.velocity});
  }
}

void Sponges::damp(Particles& particles, double step) const {
  for_each(particles.water, [&](std::size_t i, int) {
    Record& record = particles.record[i];
    for (const Zone& zone : zones_) {
      bool inside = true;
      for (int c = 0; c < dimension_; ++c)
        inside = inside && record.x[c] >= zone.region.lower[c] && record.x[c] <= zone.region.upper[c];
      if (!inside) continue;
      const double way = (record.x[zone.axis] - zone.start) * zone.per_length;
      const double left = std::exp(-step * zone.rate * way * way);
      for (int c = 0; c < dimension_; ++c) record.v[c] = zone.velocity[c] + left * (record.v[c] - zone.velocity[c]);
    }
  });
}

}  // namespace embacle::mps
