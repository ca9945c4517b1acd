#include "core/turbulence.hpp"

#include <cmath>

#include "core/dispatch.hpp"
#include "core/symmetric.hpp"

namespace embacle::mps {

namespace {

/// Of (d/n0) SUM F r r, which is 1 in the full lattice and about 0.5 at a level surface: below it, neighbours are too
/// few, or in one line, for a gradient.
constexpr double least_eigenvalue = 0.1;

}  // namespace

void Turbulence::apply(const Particles& particles, const Neighbours& neighbours, Halo& halo,
                       std::vector<Triple>& acceleration) {
  make_room(viscosity_, particles.record.size());
  viscosity_.assign(particles.record.size(), 0.0);
  dispatch(constants_, [&]<int D, KernelKind K>() { measure<D, K>(particles, neighbours); });
  halo.update_water_rows(viscosity_);
  dispatch(constants_, [&]<int D, KernelKind K>() { add<D, K>(particles, neighbours, acceleration); });
}

/// The eddy viscosity of the own water.
template <int D, KernelKind K>
void Turbulence::measure(const Particles& particles, const Neighbours& neighbours) {
  const Kernel<K> kernel{1.0 / constants_.support};
  const Record* records = particles.record.data();
  const double length = constants_.smagorinsky * constants_.particle_distance;
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};  // as in Symmetric
  for_each(particles.water, [&](std::size_t i, int) {
    const Record& me = records[i];
    const NeighbourRange range = neighbours.of_water(i);
    Pack arms[6], flux[3][3];  // SUM F r r, SUM F (v_j - v_i) r
    for (Pack& sum : arms) sum = splat(0);
    for (auto& row : flux)
      for (Pack& sum : row) sum = splat(0);
    for (auto k = range.begin; k < range.middle; k += lanes) {
      const RecordPack other = load(records, k);
      const Pack r[3] = {other.x - me.x[0], other.y - me.x[1], other.z - me.x[2]};
      const Pack u[3] = {other.vx - me.v[0], other.vy - me.v[1], other.vz - me.v[2]};
      const Pack f = kernel.gradient_weight(square_root(dot<D>(r[0], r[1], r[2], r[0], r[1], r[2])), max_zero);
      for (int c = 0; c < 6; ++c) {
        if (pairs[c][0] < D && pairs[c][1] < D) arms[c] += f * r[pairs[c][0]] * r[pairs[c][1]];
      }
      for (int a = 0; a < D; ++a) {
        for (int b = 0; b < D; ++b) flux[a][b] += f * u[a] * r[b];
      }
    }
    Symmetric m;
    for (int c = 0; c < 6; ++c) m[c] = constants_.gradient_factor * horizontal_sum(arms[c]);
    if (all_eigenvalues_above(m, least_eigenvalue, D)) {
      invert(m, D);
    } else {
      for (int c = 0; c < 6; ++c) m[c] = c < 3 ? 1 : 0;
    }
    const double inverse[3][3] = {{m[0], m[3], m[5]}, {m[3], m[1], m[4]}, {m[5], m[4], m[2]}};
    double gradient[3][3] = {};
    for (int a = 0; a < D; ++a) {
      for (int b = 0; b < D; ++b) {
        for (int c = 0; c < D; ++c)
          gradient[a][b] += constants_.gradient_factor * horizontal_sum(flux[a][c]) * inverse[c][b];
      }
    }
    double square = 0;  // 2 S:S
    for (int a = 0; a < D; ++a) {
      for (int b = 0; b < D; ++b) square += 0.5 * std::pow(gradient[a][b] + gradient[b][a], 2);
    }
    viscosity_[i] = length * length * std::sqrt(square);
  });
}

template <int D, KernelKind K>
void Turbulence::add(const Particles& particles, const Neighbours& neighbours,
                     std::vector<Triple>& acceleration) const {
  const Kernel<K> kernel{1.0 / constants_.support};
  const Record* records = particles.record.data();
  const double half = 0.5 * constants_.laplacian_factor;
  for_each(particles.water, [&](std::size_t i, int) {
    const Record& me = records[i];
    const NeighbourRange range = neighbours.of_water(i);
    Pack ax = splat(0), ay = splat(0), az = splat(0);
    for (auto k = range.begin; k < range.middle; k += lanes) {
      const RecordPack other = load(records, k);
      const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
      const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
      const Pack theirs = {viscosity_[k[0]], viscosity_[k[1]], viscosity_[k[2]], viscosity_[k[3]]};
      const Pack factor = half * (viscosity_[i] + theirs) * kernel.gradient_weight(square_root(r2), max_zero) * r2;
      ax += factor * (other.vx - me.v[0]);
      ay += factor * (other.vy - me.v[1]);
      if constexpr (D == 3) az += factor * (other.vz - me.v[2]);
    }
    acceleration[i][0] += horizontal_sum(ax);
    acceleration[i][1] += horizontal_sum(ay);
    acceleration[i][2] += horizontal_sum(az);
  });
}

}  // namespace embacle::mps
