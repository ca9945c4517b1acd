#include "core/diagnostics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace embacle::mps {

namespace {

/// Smooth number density whose sum hardly depends on the arrangement of particles: (1-q)^4 (4q+1).
double arrangement_weight(double q) {
  if (q >= 1) return 0;
  const double rest = (1 - q) * (1 - q);
  return rest * rest * (4 * q + 1);
}

struct Arrangement {
  double sum = 0;
  Triple slope{};
};

Arrangement arrangement_of(const Simulation& simulation, std::size_t i) {
  const auto& records = simulation.particles().record;
  const double support = simulation.constants().support;
  Arrangement result;
  const NeighbourRange range = simulation.neighbours().of_water(i);
  for (auto k = range.begin; k < range.end; ++k) {
    Triple d;
    double r2 = 0;
    for (int c = 0; c < 3; ++c) {
      d[c] = records[*k].x[c] - records[i].x[c];
      r2 += d[c] * d[c];
    }
    const double w = arrangement_weight(std::sqrt(r2) / support);
    result.sum += w;
    for (int c = 0; c < 3; ++c) result.slope[c] += w * d[c];
  }
  return result;
}

double lattice_arrangement(const Constants& constants) {
  const int reach = static_cast<int>(std::ceil(constants.support / constants.particle_distance));
  double sum = 0;
  for (int k = constants.dimension == 3 ? -reach : 0; k <= (constants.dimension == 3 ? reach : 0); ++k) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        if (i != 0 || j != 0 || k != 0) {
          sum += arrangement_weight(std::sqrt(i * i + j * j + k * k) * constants.particle_distance / constants.support);
        }
      }
    }
  }
  return sum;
}

/// How far [m] a place lies beyond the closed faces of a tank; negative inside. `pose`: of each wall.
double outside_tank(const Scene& scene, const std::vector<Pose>& pose, const double* place) {
  static constexpr const char* names = "xyz";
  double farthest = -std::numeric_limits<double>::infinity();
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    if (wall.kind != Wall::Kind::tank) continue;
    const Vec3d x = pose[w].zero({place[0], place[1], place[2]});
    const auto closed = [&](int c, char sign) {
      return std::find(wall.open.begin(), wall.open.end(), std::string{names[c], sign}) == wall.open.end();
    };
    for (int c = 0; c < scene.dimension; ++c) {
      if (closed(c, '-')) farthest = std::max(farthest, wall.region.lower[c] - x[c]);
      if (closed(c, '+')) farthest = std::max(farthest, x[c] - wall.region.upper[c]);
    }
  }
  return farthest;
}

double dot(const double* a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

std::int64_t interactions(const Particles& particles, const Neighbours& neighbours, double support) {
  if (neighbours.pairs() == 0) return 0;  // no lists yet
  const auto within = [&](std::size_t i, const NeighbourRange& range) {
    const double* x = particles.record[i].x;
    return std::count_if(range.begin, range.end, [&](std::uint32_t j) {
      const double* y = particles.record[j].x;
      const double r[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
      return r[0] * r[0] + r[1] * r[1] + r[2] * r[2] < support * support;
    });
  };
  std::int64_t count = 0;
  for (std::size_t i = 0; i < particles.water; ++i) count += 2 * within(i, neighbours.of_water(i));
  const auto& wet = neighbours.wet_points();
  for (std::size_t k = 0; k < wet.size(); ++k) count += within(wet[k], neighbours.of_wet_point(k));
  return count;
}

WaterState measure(const Simulation& simulation, const Scene& scene) {
  const Constants& c = simulation.constants();
  const Particles& particles = simulation.particles();
  const double full = lattice_arrangement(c);
  const double tait = c.sound_speed * c.sound_speed / 7.0;
  std::vector<Pose> pose(simulation.walls().count());
  for (std::size_t w = 0; w < pose.size(); ++w) {
    pose[w] = simulation.walls().course(static_cast<int>(w)).pose(simulation.time());
  }
  double sums[16] = {};
  double deepest[2] = {0, 0};  // in a body, beyond a tank
  for (std::size_t i = 0; i < particles.water; ++i) {
    const Record& record = particles.record[i];
    const double m = c.particle_mass;
    const Triple kick = simulation.half_kick(i);
    sums[0] += 1;
    for (int d = 0; d < 3; ++d) {
      const double v = record.v[d] - kick[d];
      sums[1] += 0.5 * m * (v * v + kick[d] * kick[d]);  // mean of half a step before and after: impulses leave no dent
      sums[2] -= m * c.static_gravity[d] * record.x[d];
      sums[4 + d] += m * v;
    }
    if (c.central_force > 0) sums[2] += m * central_potential(c, record.x);
    // Elastic energy of the Tait fluid: m INT p/rho0 ds, conjugate to a continuity equation and a gradient over rho0.
    sums[3] += m * tait * ((std::pow(record.s, 8) - 1.0) / 8.0 - (record.s - 1.0));
    sums[11] += std::abs(record.s - 1.0) > 0.01 ? 1 : 0;
    const Arrangement around = arrangement_of(simulation, i);
    const double slope = std::sqrt(around.slope[0] * around.slope[0] + around.slope[1] * around.slope[1] +
                                   around.slope[2] * around.slope[2]);
    if (around.sum > 0.8 * full && slope < 0.05 * full * c.particle_distance) {
      sums[7] += 1;
      sums[8] += (1.0 + full) / (1.0 + around.sum);
    }
    const double outside = outside_tank(scene, pose, record.x);
    sums[9] += outside > 0 ? 1 : 0;
    deepest[1] = std::max(deepest[1], outside);
    if (simulation.bodies() != nullptr) {
      const Bodies& bodies = *simulation.bodies();
      double depth = 0;
      for (const std::uint32_t b : bodies.near(i))
        depth = std::max(depth, bodies.depth_in(b, coupling::Vec3(record.x[0], record.x[1], record.x[2])));
      sums[10] += depth > 0 ? 1 : 0;
      deepest[0] = std::max(deepest[0], depth);
    }
  }
  sums[12] = simulation.energy_in_solids();
  if (simulation.bodies() != nullptr) {
    const auto [kinetic, potential] = simulation.bodies()->energy(simulation.rank());
    sums[13] = kinetic;
    sums[14] = potential;
    sums[15] = simulation.work_on_bodies();
  }
  double total[16];
  MPI_Allreduce(sums, total, 16, MPI_DOUBLE, MPI_SUM, simulation.comm());
  MPI_Allreduce(MPI_IN_PLACE, deepest, 2, MPI_DOUBLE, MPI_MAX, simulation.comm());
  WaterState state;
  state.particles = static_cast<std::int64_t>(total[0]);
  state.mass = total[0] * c.particle_mass;
  state.energy = {total[1], total[2], total[3], total[12], total[13] + total[14], total[15]};
  state.kinetic_of_bodies = total[13];
  state.momentum = {total[4], total[5], total[6]};
  state.volume_ratio = total[7] > 0 ? total[8] / total[7] : std::numeric_limits<double>::quiet_NaN();
  state.interior_share = total[0] > 0 ? total[7] / total[0] : 0;
  state.outside_tank = static_cast<std::int64_t>(total[9]);
  state.inside_bodies = static_cast<std::int64_t>(total[10]);
  state.deepest_in_body = deepest[0];
  state.farthest_outside_tank = deepest[1];
  state.compressed_share = total[0] > 0 ? total[11] / total[0] : 0;
  return state;
}

double water_level(const Simulation& simulation, const Scene& scene, const Gauge& gauge) {
  const Constants& c = simulation.constants();
  Vec3d up{};
  const double* const weight = c.static_gravity;
  const double norm = std::sqrt(dot(weight, {weight[0], weight[1], weight[2]}));
  if (norm == 0) return std::numeric_limits<double>::quiet_NaN();
  for (int d = 0; d < 3; ++d) up[d] = -weight[d] / norm;
  std::vector<double> heights;
  for (std::size_t i = 0; i < simulation.particles().water; ++i) {
    const double* x = simulation.particles().record[i].x;
    double offset[3], along = 0, square = 0;
    for (int d = 0; d < 3; ++d) {
      offset[d] = d < scene.dimension ? c.periodic.nearest(d, x[d] - gauge.position[d]) : 0;
      along += offset[d] * up[d];
    }
    for (int d = 0; d < 3; ++d) square += std::pow(offset[d] - along * up[d], 2);
    if (square < c.particle_distance * c.particle_distance) heights.push_back(dot(x, up));
  }
  int rank = 0, size = 1;
  MPI_Comm_rank(simulation.comm(), &rank);
  MPI_Comm_size(simulation.comm(), &size);
  std::vector<int> counts(size), offsets(size);
  int mine = static_cast<int>(heights.size());
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, simulation.comm());
  for (int r = 1; r < size; ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  std::vector<double> all(offsets[size - 1] + counts[size - 1]);
  MPI_Allgatherv(heights.data(), mine, MPI_DOUBLE, all.data(), counts.data(), offsets.data(), MPI_DOUBLE,
                 simulation.comm());
  if (all.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(all.begin(), all.end());
  std::size_t top = 0;
  while (top + 1 < all.size() && all[top + 1] - all[top] < 2 * c.particle_distance) ++top;
  return all[top] + 0.5 * c.particle_distance;
}

double pressure_at(const Simulation& simulation, const Gauge& gauge) {
  const Constants& c = simulation.constants();
  double sums[2] = {};
  for (std::size_t i = 0; i < simulation.particles().water; ++i) {
    const Record& record = simulation.particles().record[i];
    double square = 0, head = 0;
    for (int d = 0; d < c.dimension; ++d) {
      const double offset = c.periodic.nearest(d, gauge.position[d] - record.x[d]);
      square += offset * offset;
      head += c.static_gravity[d] * offset;
    }
    const double rest = 1 - std::sqrt(square) / c.support;
    if (rest <= 0) continue;
    if (c.central_force > 0) head -= central_potential(c, gauge.position.data()) - central_potential(c, record.x);
    sums[0] += rest * rest * rest;
    sums[1] += rest * rest * rest * (record.p + c.density * head);
  }
  double total[2];
  MPI_Allreduce(sums, total, 2, MPI_DOUBLE, MPI_SUM, simulation.comm());
  return total[0] > 0 ? std::max(0.0, total[1] / total[0]) : std::numeric_limits<double>::quiet_NaN();
}

double front_position(const Simulation& simulation, const Gauge& gauge) {
  const Constants& c = simulation.constants();
  const auto& records = simulation.particles().record;
  double farthest = -1e300;
  for (std::size_t i = 0; i < simulation.particles().water; ++i) {
    const double along = dot(records[i].x, gauge.direction) + 0.5 * c.particle_distance;
    if (along <= farthest) continue;
    int close = 0;  // a lone splash is no front
    const NeighbourRange range = simulation.neighbours().of_water(i);
    for (auto k = range.begin; k < range.middle; ++k) {
      double square = 0;
      for (int d = 0; d < 3; ++d) square += std::pow(records[*k].x[d] - records[i].x[d], 2);
      close += square < 2.25 * c.particle_distance * c.particle_distance ? 1 : 0;
    }
    if (close >= 2) farthest = along;
  }
  double result = 0;
  MPI_Allreduce(&farthest, &result, 1, MPI_DOUBLE, MPI_MAX, simulation.comm());
  return result;
}

}  // namespace embacle::mps
