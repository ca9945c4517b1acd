#include "core/central_force.hpp"

#include "core/dispatch.hpp"

namespace embacle::mps {

namespace {

template <int D, KernelKind K>
void hydrostatic_part(const Particles& particles, const Neighbours& neighbours, const Constants& c,
                      std::vector<double>& change) {
  const Kernel<K> kernel{1.0 / c.support};
  const Record* records = particles.record.data();
  const double factor =
      c.step * c.density_diffusion * c.laplacian_factor * c.central_force / (c.sound_speed * c.sound_speed);
  for (std::size_t i = 0; i < particles.water; ++i) {
    const Record& me = records[i];
    const NeighbourRange range = neighbours.of_water(i);
    Pack sum = splat(0);
    for (auto k = range.begin; k < range.middle; k += lanes) {
      const RecordPack other = load(records, k);
      const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
      const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
      const Pack f = kernel.gradient_weight(square_root(r2), max_zero);
      const Pack slope = 7.0 - 3.0 * (me.s + other.s);  // as in operators.cpp
      const Pack along = dot<D>(dx, dy, dz, 0.5 * (other.x + me.x[0]) - c.centre[0],
                                0.5 * (other.y + me.x[1]) - c.centre[1], 0.5 * (other.z + me.x[2]) - c.centre[2]);
      sum += f * r2 * slope * along;
    }
    change[i] = factor * horizontal_sum(sum);
  }
}

}  // namespace

void CentralForce::correct_density(Particles& particles, const Neighbours& neighbours) {
  if (constants_.density_diffusion == 0) return;
  change_.resize(particles.water);
  dispatch(constants_,
           [&]<int D, KernelKind K>() { hydrostatic_part<D, K>(particles, neighbours, constants_, change_); });
  for (std::size_t i = 0; i < particles.water; ++i) {
    Record& record = particles.record[i];
    record.s += change_[i];
    record.p = pressure_of(record.s, constants_);
  }
}

void CentralForce::accelerate(const Particles& particles, std::vector<Triple>& acceleration) const {
  for (std::size_t i = 0; i < particles.water; ++i) {
    const Triple mine = at(particles.record[i].x);
    for (int d = 0; d < 3; ++d) acceleration[i][d] += mine[d];
  }
}

void CentralForce::relieve_points(const Particles& particles, const Neighbours& neighbours,
                                  std::vector<Triple>& acceleration) const {
  const auto& wet = neighbours.wet_points();
  for (std::size_t k = 0; k < wet.size(); ++k) {
    const Triple mine = at(particles.record[wet[k]].x);
    for (int d = 0; d < 3; ++d) acceleration[k][d] -= mine[d];
  }
}

}  // namespace embacle::mps
