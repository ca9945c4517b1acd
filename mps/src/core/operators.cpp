#include "core/operators.hpp"

#include <algorithm>

#include "core/dispatch.hpp"

namespace embacle::mps {

namespace {

template <int D, KernelKind K>
void density_rate(Particles& particles, const Neighbours& neighbours, const Constants& c, double back) {
  const Kernel<K> kernel{1.0 / c.support};
  const Record* records = particles.record.data();
  const double inverse_c2 = 1.0 / (c.sound_speed * c.sound_speed);
  const Pack gx = splat(c.diffusion_gravity[0] * inverse_c2), gy = splat(c.diffusion_gravity[1] * inverse_c2),
             gz = splat(c.diffusion_gravity[2] * inverse_c2);
  const double diffusion = c.density_diffusion * c.laplacian_factor;
  // With `back`, geometry of the middle of the step that led here: with that of its end, compression and expansion
  // along the same way do not cancel, and water gains volume and energy in proportion to the step.
  for_each(particles.water, [&](std::size_t i, int) {
    const Record& me = records[i];
    const NeighbourRange range = neighbours.of_water(i);
    Pack divergence = splat(0), laplacian = splat(0);
    const auto pair = [&]<bool Water>(PackedIndices::Iterator index) {
      const RecordPack other = load(records, index);
      const Pack ux = other.vx - me.v[0], uy = other.vy - me.v[1], uz = other.vz - me.v[2];
      const Pack dx = other.x - me.x[0] - back * ux, dy = other.y - me.x[1] - back * uy,
                 dz = other.z - me.x[2] - back * uz;
      const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
      const Pack f = kernel.gradient_weight(square_root(r2), max_zero);
      divergence += f * dot<D>(ux, uy, uz, dx, dy, dz);
      if constexpr (Water) {
        // At rest ds = (g.dr/c0^2) s^-6 by the Tait equation; s^-6 to first order, with the mean of both s.
        const Pack slope = 7.0 - 3.0 * (me.s + other.s);
        laplacian += f * r2 * ((other.s - me.s) - slope * dot<D>(gx, gy, gz, dx, dy, dz));
      }
    };
    for (auto k = range.begin; k < range.middle; k += lanes) pair.template operator()<true>(k);
    for (auto k = range.middle; k < range.end; k += lanes) pair.template operator()<false>(k);
    // In place of the pressure, which the sweep does not read and which is due next.
    particles.record[i].p = -c.gradient_factor * horizontal_sum(divergence) + diffusion * horizontal_sum(laplacian);
  });
}

template <int D, KernelKind K>
void extrapolate(Particles& particles, const Neighbours& neighbours, const Constants& c,
                 const std::vector<Triple>& acceleration, Part part) {
  const Kernel<K> kernel{1.0 / c.support};
  Record* records = particles.record.data();
  const auto& wet = neighbours.wet_points();
  const Subset chosen = neighbours.wet(part);
  for_each(chosen.size(), [&](std::size_t n, int) {
    const std::size_t k = chosen[n];
    Record& me = records[wet[k]];
    double g[3] = {c.static_gravity[0], c.static_gravity[1], c.static_gravity[2]};
    if (!acceleration.empty()) {
      for (int d = 0; d < 3; ++d) g[d] -= acceleration[k][d];
    }
    for (double& component : g) component *= c.density;
    const NeighbourRange range = neighbours.of_wet_point(k);
    Pack weights = splat(0), sum = splat(0);
    for (auto j = range.begin; j < range.end; j += lanes) {
      const RecordPack other = load(records, j);
      const Pack dx = me.x[0] - other.x, dy = me.x[1] - other.y, dz = me.x[2] - other.z;
      const Pack f = kernel.gradient_weight(square_root(dot<D>(dx, dy, dz, dx, dy, dz)), max_zero);
      weights += f;
      sum += f * (other.p + dot<D>(splat(g[0]), splat(g[1]), splat(g[2]), dx, dy, dz));
    }
    const double weight = horizontal_sum(weights);
    me.p = weight > 0 ? std::max(0.0, horizontal_sum(sum) / weight) : 0.0;
  });
}

template <int D, KernelKind K, bool Viscous>
void forces(const Particles& particles, const Neighbours& neighbours, const Constants& c,
            std::vector<Triple>& acceleration, Reactions& reaction, Part part) {
  const Kernel<K> kernel{1.0 / c.support};
  const Record* records = particles.record.data();
  const double pressure_factor = -c.gradient_factor / c.density;
  const double damping_factor = c.gradient_factor * c.artificial_viscosity;
  const double viscous_factor = c.viscosity * c.laplacian_factor;
  const double solid_factor = c.wall_friction ? 0.0 : 2.0 * viscous_factor;
  const double water_collision = c.collision_distance * c.collision_distance;
  const double solid_distance = c.collision_distance > 0 ? 0.5 * c.particle_distance : 0.0;
  const double solid_collision = solid_distance * solid_distance;
  const double water_impulse = 0.5 * (1.0 + c.collision_restitution) / c.step;
  const double solid_impulse = (1.0 + c.collision_restitution) / c.step;

  if (part != Part::rim) {
    resize(acceleration, particles.water);
    reaction.reset(reaction_slots(particles));
  }
  const Subset chosen = neighbours.water(part);
  for_each(chosen.size(), [&](std::size_t number, int thread) {
    const std::size_t i = chosen[number];
    Triple* const on_points = reaction.of_thread(thread);
    const Record& me = records[i];
    const NeighbourRange range = neighbours.of_water(i);
    Pack ax = splat(0), ay = splat(0), az = splat(0);
    const auto pair = [&]<bool Water>(PackedIndices::Iterator index) {
      const RecordPack other = load(records, index);
      const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
      const Pack r2 = dot<D>(dx, dy, dz, dx, dy, dz);
      const Pack f = kernel.gradient_weight(square_root(r2), max_zero);
      const Pack ux = other.vx - me.v[0], uy = other.vy - me.v[1], uz = other.vz - me.v[2];
      const Pack approach = dot<D>(ux, uy, uz, dx, dy, dz) / (r2 + 1e-300);  // v_ij.r_ij/r^2
      Pack along = f * (pressure_factor * (me.p + other.p));
      if constexpr (Water) along += f * (damping_factor * approach);
      const Pack impulse = approach * (Water ? water_impulse : solid_impulse);
      const auto collides = (r2 < (Water ? water_collision : solid_collision)) & (approach < 0.0);
      along += collides ? impulse : splat(0.0);
      Pack fx = along * dx, fy = along * dy, fz = along * dz;
      if constexpr (Viscous) {
        const Pack laplacian = f * r2 * (Water ? viscous_factor : solid_factor);
        fx += laplacian * ux;
        fy += laplacian * uy;
        fz += laplacian * uz;
      }
      ax += fx;
      ay += fy;
      if constexpr (D == 3) az += fz;
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
  });
}

template <int D, KernelKind K>
double solid_power(const Particles& particles, const Neighbours& neighbours, const Constants& c,
                   const std::vector<Triple>& acceleration) {
  const Kernel<K> kernel{1.0 / c.support};
  const Record* records = particles.record.data();
  const double half_step = 0.5 * c.step;
  ThreadSums<double> sums;
  sums.reset(1);
  for_each(particles.water, [&](std::size_t i, int thread) {
    const NeighbourRange range = neighbours.of_water(i);
    if (range.middle == range.end) return;
    const Record& me = records[i];
    double v[3];
    for (int d = 0; d < 3; ++d) v[d] = me.v[d] - half_step * acceleration[i][d];
    Pack sum = splat(0);
    for (auto k = range.middle; k < range.end; k += lanes) {
      const RecordPack other = load(records, k);
      const Pack dx = other.x - me.x[0], dy = other.y - me.x[1], dz = other.z - me.x[2];
      const Pack f = kernel.gradient_weight(square_root(dot<D>(dx, dy, dz, dx, dy, dz)), max_zero);
      sum += f * other.p * dot<D>(v[0] - other.vx, v[1] - other.vy, v[2] - other.vz, dx, dy, dz);
    }
    *sums.of_thread(thread) += horizontal_sum(sum);
  });
  sums.join();
  return c.gradient_factor * c.particle_mass / c.density * sums.total()[0];
}

}  // namespace

void advance_density(Particles& particles, const Neighbours& neighbours, const Constants& constants, double step,
                     double back) {
  dispatch(constants, [&]<int D, KernelKind K>() { density_rate<D, K>(particles, neighbours, constants, back); });
  for_each(particles.water, [&](std::size_t i, int) {
    Record& record = particles.record[i];
    record.s += step * record.p;
    record.p = pressure_of(record.s, constants);
  });
}

void extrapolate_pressure(Particles& particles, const Neighbours& neighbours, const Constants& constants,
                          const std::vector<Triple>& acceleration, Part part) {
  dispatch(constants,
           [&]<int D, KernelKind K>() { extrapolate<D, K>(particles, neighbours, constants, acceleration, part); });
}

void accelerate(const Particles& particles, const Neighbours& neighbours, const Constants& constants,
                std::vector<Triple>& acceleration, Reactions& reaction, Part part) {
  dispatch(constants, [&]<int D, KernelKind K>() {
    if (constants.viscosity > 0) {
      forces<D, K, true>(particles, neighbours, constants, acceleration, reaction, part);
    } else {
      forces<D, K, false>(particles, neighbours, constants, acceleration, reaction, part);
    }
  });
}

double power_into_solids(const Particles& particles, const Neighbours& neighbours, const Constants& constants,
                         const std::vector<Triple>& acceleration) {
  double power = 0;
  dispatch(constants,
           [&]<int D, KernelKind K>() { power = solid_power<D, K>(particles, neighbours, constants, acceleration); });
  return power;
}

}  // namespace embacle::mps
