#include "core/corrections.hpp"

#include <algorithm>
#include <cmath>

#include "core/dispatch.hpp"
#include "core/symmetric.hpp"

namespace embacle::mps {

namespace {

// Bounds of the concentration: below the first a particle flies alone, between them it may be at the free surface.
constexpr double external_concentration = 0.4;
constexpr double surface_concentration = 0.9;
constexpr double least_eigenvalue = 0.5;    ///< of the matrix that is inverted
constexpr double least_density = 0.9;       ///< of rest; the equation of state holds nowhere near such tension
constexpr double interior_collision = 0.5;  ///< distance below which particles collide in the interior, in l0

double inner_product(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Product of symmetric matrices, given by columns or numbers, and vectors.
template <int D, class Matrix>
std::array<Pack, 3> product(const Matrix& b, Pack dx, Pack dy, Pack dz) {
  if constexpr (D == 2) return {b[0] * dx + b[3] * dy, b[3] * dx + b[1] * dy, splat(0)};
  return {b[0] * dx + b[3] * dy + b[5] * dz, b[3] * dx + b[1] * dy + b[4] * dz, b[5] * dx + b[4] * dy + b[2] * dz};
}

double largest(Pack value) { return std::max(std::max(value[0], value[1]), std::max(value[2], value[3])); }

}  // namespace

void Corrections::update(Particles& particles, const Neighbours& neighbours, Halo& halo, double fastest) {
  make_room(correction_, particles.record.size());
  make_room(surface_, particles.record.size());
  correction_.assign(particles.record.size(), {});
  surface_.assign(particles.record.size(), {});
  dispatch(constants_, [&]<int D, KernelKind K>() { measure<D, K>(particles, neighbours, fastest); });
  halo.update_water_rows(surface_);
  dispatch(constants_, [&]<int D, KernelKind K>() { classify<D, K>(particles, neighbours); });
  halo.update_water_rows(correction_);
}

/// The matrices before inversion, concentration, free surface, and the shifting velocity of the interior.
template <int D, KernelKind K>
void Corrections::measure(const Particles& particles, const Neighbours& neighbours, double fastest) {
  const Kernel<K> kernel{1.0 / constants_.support};
  const Kernel<KernelKind::rational> crowding{1.0 / constants_.support};
  const Record* records = particles.record.data();
  resize(concentration_, particles.water);
  resize(shift_, particles.water);
  for_each(particles.water, [&](std::size_t i, int) {
    const Record& me = records[i];
    const NeighbourRange range = neighbours.of_water(i);
    Pack weight = splat(0), laplacian = splat(0), speed = splat(0);
    Pack gx = splat(0), gy = splat(0), gz = splat(0);
    Pack xx = splat(0), yy = splat(0), zz = splat(0), xy = splat(0), yz = splat(0), zx = splat(0);
    for (auto k = range.begin; k < range.end; k += lanes) {
      const RecordPack other = load(records, k);
      const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
      const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
      const Pack f = kernel.gradient_weight(square_root(r2), max_zero);
      const Pack w = f * r2;
      weight += w;
      laplacian += w * r2;
      const Pack fx = f * dx, fy = f * dy, fz = f * dz;
      const Pack push = crowding.gradient_weight(square_root(r2), max_zero);
      gx += push * dx;
      gy += push * dy;
      xx += fx * dx;
      yy += fy * dy;
      xy += fx * dy;
      if constexpr (D == 3) {
        gz += push * dz;
        zz += fz * dz;
        yz += fy * dz;
        zx += fz * dx;
      }
      const Pack ux = other.vx - me.v[0], uy = other.vy - me.v[1], uz = other.vz - me.v[2];
      const Pack square = f > 0.0 ? dot<D>(ux, uy, uz, ux, uy, uz) : splat(0.0);
      speed = speed > square ? speed : square;
    }
    Correction& mine = correction_[i];
    const double m[6] = {horizontal_sum(xx), horizontal_sum(yy), horizontal_sum(zz),
                         horizontal_sum(xy), horizontal_sum(yz), horizontal_sum(zx)};
    for (int k = 0; k < 6; ++k) mine.b[k] = constants_.gradient_factor * m[k];
    // A free surface would make the water there more viscous.
    mine.laplacian = constants_.plain_operators
                         ? constants_.lattice.weight_square
                         : std::max(horizontal_sum(laplacian), 0.8 * constants_.lattice.weight_square);
    concentration_[i] = horizontal_sum(weight) / constants_.lattice.weight;
    const double gradient[3] = {horizontal_sum(gx), horizontal_sum(gy), horizontal_sum(gz)};
    const double steepness = std::sqrt(inner_product(gradient, gradient));
    const double local = std::min(fastest, 2 * std::sqrt(largest(speed)));
    const double scale =
        -2 * constants_.particle_distance * local * constants_.shifting * 2 * constants_.crowding_factor;
    const double bounded = std::min(1.0, steepness > 0 ? 0.5 * local / (std::abs(scale) * steepness + 1e-300) : 1.0);
    for (int c = 0; c < 3; ++c) shift_[i][c] = scale * bounded * gradient[c];
    if (concentration_[i] >= surface_concentration) return;
    Surface& surface = surface_[i];
    for (int c = 0; c < 3; ++c) surface.normal[c] = steepness > 0 ? -gradient[c] / steepness : 0.0;
    if (concentration_[i] < external_concentration || at_surface(particles, neighbours, i, surface.normal)) {
      surface.is_surface = 1;
    } else {
      surface = {};
    }
  });
}

/// Whether no neighbour stands in the umbrella above a particle (thesis eq 5.34; in 3-D with the distance from the axis
/// in place of the tangential one).
bool Corrections::at_surface(const Particles& particles, const Neighbours& neighbours, std::size_t i,
                             const double* normal) const {
  const double l0 = constants_.particle_distance;
  const double* x = particles.record[i].x;
  const NeighbourRange range = neighbours.of_water(i);
  return std::none_of(range.begin, range.end, [&](std::uint32_t j) {
    const double* y = particles.record[j].x;
    const double r[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
    const double square = inner_product(r, r);
    if (square > constants_.support * constants_.support) return false;
    double to_tip[3];
    for (int c = 0; c < 3; ++c) to_tip[c] = r[c] - l0 * normal[c];
    const double tip_square = inner_product(to_tip, to_tip);
    if (square >= 2 * l0 * l0) return tip_square < l0 * l0;
    const double along = inner_product(to_tip, normal);
    return std::abs(along) + std::sqrt(std::max(0.0, tip_square - along * along)) < l0;
  });
}

/// Interior or not; matrices inverted where they can be trusted; shifting kept from leading out of the water.
template <int D, KernelKind K>
void Corrections::classify(const Particles& particles, const Neighbours& neighbours) {
  const Kernel<K> kernel{1.0 / constants_.support};
  for_each(particles.water, [&](std::size_t i, int) {
    const NeighbourRange range = neighbours.of_water(i);
    Surface mine = surface_[i];
    bool near = mine.is_surface > 0;
    if (!near) {
      for (auto k = range.begin; k < range.middle; ++k) {
        const Surface& other = surface_[*k];
        if (other.is_surface == 0) continue;
        double square = 0;
        for (int c = 0; c < 3; ++c) square += std::pow(particles.record[*k].x[c] - particles.record[i].x[c], 2);
        const double weight = square * kernel.gradient_weight(std::sqrt(square));
        if (weight == 0) continue;
        near = true;
        for (int c = 0; c < 3; ++c) mine.normal[c] += weight * other.normal[c];
      }
      const double norm = std::sqrt(inner_product(mine.normal, mine.normal));
      for (int c = 0; c < 3 && norm > 0; ++c) mine.normal[c] /= norm;
    }
    Correction& correction = correction_[i];
    if (near) {
      Triple& u = shift_[i];
      const double outward = inner_product(u.data(), mine.normal);
      if (concentration_[i] < external_concentration) {
        u = {};
      } else if (mine.is_surface > 0 || outward > 0) {
        for (int c = 0; c < 3; ++c) u[c] -= outward * mine.normal[c];
      }
    }
    correction.interior = near ? 0 : 1;
    if (!near && !constants_.plain_operators && all_eigenvalues_above(correction.b, least_eigenvalue, D)) {
      invert(correction.b, D);
    } else {
      std::copy_n(Correction{}.b, 6, correction.b);
    }
  });
}

void Corrections::advance_density(Particles& particles, const Neighbours& neighbours) const {
  dispatch(constants_, [&]<int D, KernelKind K>() {
    const Constants& c = constants_;
    const Kernel<K> kernel{1.0 / c.support};
    const Record* records = particles.record.data();
    const double inverse_c2 = 1.0 / (c.sound_speed * c.sound_speed);
    const Pack gx = splat(c.diffusion_gravity[0] * inverse_c2), gy = splat(c.diffusion_gravity[1] * inverse_c2),
               gz = splat(c.diffusion_gravity[2] * inverse_c2);
    const double diffusion = c.density_diffusion * c.laplacian_factor;
    for_each(particles.water, [&](std::size_t i, int) {
      const Record& me = records[i];
      const double* b = correction_[i].b;
      const Triple u = c.plain_operators ? Triple{} : shift_[i];
      const NeighbourRange range = neighbours.of_water(i);
      Pack divergence = splat(0), laplacian = splat(0), carried = splat(0);
      const auto pair = [&]<bool Water>(PackedIndices::Iterator index) {
        const RecordPack other = load(records, index);
        const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
        const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
        const Pack f = kernel.gradient_weight(square_root(r2), max_zero);
        const auto br = product<D>(b, dx, dy, dz);
        divergence += f * dot<D>(other.vx - me.v[0], other.vy - me.v[1], other.vz - me.v[2], br[0], br[1], br[2]);
        if constexpr (Water) {
          const Pack slope = 7.0 - 3.0 * (me.s + other.s);  // as in operators.cpp
          laplacian += f * r2 * ((other.s - me.s) - slope * dot<D>(gx, gy, gz, dx, dy, dz));
          carried += f * (other.s - me.s) * dot<D>(splat(u[0]), splat(u[1]), splat(u[2]), br[0], br[1], br[2]);
        }
      };
      for (auto k = range.begin; k < range.middle; k += lanes) pair.template operator()<true>(k);
      for (auto k = range.middle; k < range.end; k += lanes) pair.template operator()<false>(k);
      particles.record[i].p = c.gradient_factor * (horizontal_sum(carried) - horizontal_sum(divergence)) +
                              diffusion * horizontal_sum(laplacian);  // as in operators.cpp
    });
  });
  for_each(particles.water, [&](std::size_t i, int) {
    Record& record = particles.record[i];
    record.s = std::max(least_density, record.s + constants_.step * record.p);
    record.p = pressure_of(record.s, constants_);
  });
}

void Corrections::accelerate(const Particles& particles, const Neighbours& neighbours,
                             std::vector<Triple>& acceleration, Reactions& reaction) const {
  resize(acceleration, particles.water);
  reaction.reset(reaction_slots(particles));
  dispatch(constants_, [&]<int D, KernelKind K>() {
    const Constants& c = constants_;
    const Kernel<K> kernel{1.0 / c.support};
    const Record* records = particles.record.data();
    const double pressure_factor = -c.gradient_factor / c.density;
    const double damping_factor = c.gradient_factor * c.artificial_viscosity;
    const double viscous_factor = 4.0 * c.dimension * c.viscosity;
    const double solid_share = c.wall_friction ? 0.0 : 2.0;
    const double surface_distance = c.collision_distance * c.collision_distance;
    const double inner_distance = std::pow(std::min(interior_collision * c.particle_distance, c.collision_distance), 2);
    const double solid_distance = c.collision_distance > 0 ? 0.25 * c.particle_distance * c.particle_distance : 0.0;
    const double water_impulse = 0.5 * (1.0 + c.collision_restitution) / c.step;
    const double solid_impulse = (1.0 + c.collision_restitution) / c.step;
    for_each(particles.water, [&](std::size_t i, int thread) {
      Triple* const on_points = reaction.of_thread(thread);
      const Record& me = records[i];
      const Correction& mine = correction_[i];
      const Triple u = c.plain_operators ? Triple{} : shift_[i];
      const bool tension = me.p < 0 && mine.interior > 0 && !c.plain_operators;
      const NeighbourRange range = neighbours.of_water(i);
      Pack ax = splat(0), ay = splat(0), az = splat(0);
      // The sum of the viscous term sees a gradient wherever particles are not arranged evenly: an error that grows
      // with the resolution. It is taken out with the first moment of the weights (Fatehi & Manzari 2011,
      // doi:10.1016/j.camwa.2010.12.028), but beside walls, whose weights have their share in the friction.
      const bool centred = c.viscosity > 0 && mine.interior > 0 && !c.plain_operators && range.middle == range.end;
      Pack moment[D] = {}, slope[D][D] = {};
      const auto pair = [&]<bool Water>(PackedIndices::Iterator index) {
        const RecordPack other = load(records, index);
        const auto theirs = load_columns(correction_.data(), index);
        const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
        const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
        const Pack f = kernel.gradient_weight(square_root(r2), max_zero);
        const Pack ux = other.vx - me.v[0], uy = other.vy - me.v[1], uz = other.vz - me.v[2];
        const auto mine_r = product<D>(mine.b, dx, dy, dz);
        const auto their_r = product<D>(theirs, dx, dy, dz);
        const Pack by_mine = f * pressure_factor * (tension ? other.p - me.p : other.p);
        const Pack by_theirs = f * (tension ? 0.0 : pressure_factor * me.p);
        const Pack approach = dot<D>(ux, uy, uz, dx, dy, dz) / (r2 + 1e-300);
        const Pack inner = mine.interior * theirs[7];
        Pack along = splat(0);
        if constexpr (Water) along += f * (damping_factor * (1.0 - inner) * approach);
        const Pack reach = Water ? inner * inner_distance + (1.0 - inner) * surface_distance : splat(solid_distance);
        const auto collides = (r2 < reach) & (approach < 0.0);
        along += collides ? approach * (Water ? water_impulse : solid_impulse) : splat(0.0);
        const Pack both = Water ? mine.laplacian + theirs[6] : splat(2 * mine.laplacian);
        Pack friction = f * r2 * (viscous_factor * (Water ? 1.0 : solid_share)) / both;
        if (centred) {
          const Pack r[3] = {dx, dy, dz}, u_pair[3] = {ux, uy, uz};
          for (int b = 0; b < D; ++b) {
            moment[b] += friction * r[b];
            for (int a = 0; a < D; ++a) slope[a][b] += f * u_pair[a] * mine_r[b];
          }
        }
        if constexpr (Water) {  // padding: the sentinel has no such sum, and f = 0
          friction +=
              f * c.gradient_factor * dot<D>(splat(u[0]), splat(u[1]), splat(u[2]), mine_r[0], mine_r[1], mine_r[2]);
        }
        const Pack fx = by_mine * mine_r[0] + by_theirs * their_r[0] + along * dx + friction * ux;
        const Pack fy = by_mine * mine_r[1] + by_theirs * their_r[1] + along * dy + friction * uy;
        Pack fz = splat(0);
        if constexpr (D == 3) fz = by_mine * mine_r[2] + by_theirs * their_r[2] + along * dz + friction * uz;
        ax += fx;
        ay += fy;
        az += fz;
        if constexpr (!Water) {
          for (int lane = 0; lane < lanes; ++lane) {
            Triple& on_point = on_points[reaction_slot(particles, index[lane])];
            on_point[0] -= c.particle_mass * fx[lane];
            on_point[1] -= c.particle_mass * fy[lane];
            if constexpr (D == 3) on_point[2] -= c.particle_mass * fz[lane];
          }
        }
      };
      for (auto k = range.begin; k < range.middle; k += lanes) pair.template operator()<true>(k);
      for (auto k = range.middle; k < range.end; k += lanes) pair.template operator()<false>(k);
      acceleration[i] = {horizontal_sum(ax) + c.gravity[0], horizontal_sum(ay) + c.gravity[1],
                         horizontal_sum(az) + c.gravity[2]};
      for (int b = 0; centred && b < D; ++b) {
        const double first = c.gradient_factor * horizontal_sum(moment[b]);
        for (int a = 0; a < D; ++a) acceleration[i][a] -= first * horizontal_sum(slope[a][b]);
      }
    });
  });
}

std::size_t Corrections::bytes() const {
  return correction_.capacity() * sizeof(Correction) + surface_.capacity() * sizeof(Surface) +
         concentration_.capacity() * sizeof(double) + shift_.capacity() * sizeof(Triple);
}

}  // namespace embacle::mps
