#include "core/wall_density.hpp"

#include <algorithm>

#include "core/dispatch.hpp"

namespace embacle::mps {

void WallDensity::adopt(const std::vector<Traveller>& points) {
  stored_.resize(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) stored_[k] = points[k].record.s;
  among_.clear();
}

double WallDensity::pass(std::size_t k, bool near_water) {
  if (k == 0) among_.clear();
  if (near_water) {
    among_.push_back(static_cast<std::uint32_t>(k));
  } else {
    stored_[k] = 1;
  }
  return stored_[k];
}

void WallDensity::keep(const Particles& particles) {
  for (std::size_t n = 0; n < among_.size(); ++n) stored_[among_[n]] = particles.record[particles.water + n].s;
  among_.clear();
}

void WallDensity::restart(std::vector<double> stored, bool started) {
  stored_ = std::move(stored);
  started_ = started;
}

void WallDensity::advance(Particles& particles, const Neighbours& neighbours) {
  if (started_) {
    dispatch(constants_, [&]<int D, KernelKind K>() { rates<D, K>(particles, neighbours); });
    return;
  }
  extrapolate_pressure(particles, neighbours, constants_, {});
  for (const std::uint32_t b : neighbours.wet_points())
    particles.record[b].s = density_ratio_of(particles.record[b].p, constants_);
  started_ = true;
}

template <int D, KernelKind K>
void WallDensity::rates(Particles& particles, const Neighbours& neighbours) const {
  const Kernel<K> kernel{1.0 / constants_.support};
  Record* records = particles.record.data();
  const double half = 0.5 * constants_.step;
  const auto& wet = neighbours.wet_points();
  for_each(wet.size(), [&](std::size_t k, int) {
    Record& me = records[wet[k]];
    const NeighbourRange range = neighbours.of_wet_point(k);
    Pack divergence = splat(0), weights = splat(0);
    for (auto n = range.begin; n < range.end; n += lanes) {
      const RecordPack other = load(records, n);
      const Pack ux = other.vx - me.v[0], uy = other.vy - me.v[1], uz = other.vz - me.v[2];
      const Pack dx = other.x - me.x[0] - half * ux, dy = other.y - me.x[1] - half * uy,
                 dz = other.z - me.x[2] - half * uz;
      const Pack f = kernel.gradient_weight(square_root(dot<D>(dx, dy, dz, dx, dy, dz)), max_zero);
      divergence += f * dot<D>(ux, uy, uz, dx, dy, dz);
      weights += f;
    }
    const double rate = -constants_.gradient_factor * horizontal_sum(divergence);
    me.s = horizontal_sum(weights) > 0 ? std::max(1.0, me.s + constants_.step * rate) : 1.0;
    me.p = pressure_of(me.s, constants_);
  });
}

}  // namespace embacle::mps
