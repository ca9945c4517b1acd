#include "core/filling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "embacle/coupling/types.hpp"

namespace embacle::mps {

namespace {

/// Lattice of exactly the particle distance from the lower face on; reports what does not fit.
std::vector<double> exact_lattice(double lower, double upper, double spacing, double& misfit) {
  const int n = static_cast<int>(std::lround((upper - lower) / spacing));
  misfit = n * spacing - (upper - lower);
  std::vector<double> centres(std::max(0, n));
  for (int i = 0; i < n; ++i) centres[i] = lower + (i + 0.5) * spacing;
  return centres;
}

bool inside_box_wall(const Scene& scene, const double* x) {
  return std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Wall& wall) {
    if (wall.kind != Wall::Kind::box) return false;
    for (int c = 0; c < scene.dimension; ++c) {
      if (x[c] <= wall.region.lower[c] || x[c] >= wall.region.upper[c]) return false;
    }
    return true;
  });
}

/// Depth [m] of x below the level of a region, along gravity.
class Depth {
 public:
  Depth(const Scene& scene, const Water& water) {
    const Vec3d weight = scene.static_gravity();
    double norm = 0;
    for (const double g : weight) norm += g * g;
    norm_ = std::sqrt(norm);
    if (norm_ == 0) return;
    for (int c = 0; c < 3; ++c) down_[c] = weight[c] / norm_;
    surface_ = 1e300;  // position of the surface along `down_`
    if (water.level) {
      surface_ = -*water.level;
    } else {
      double highest = 0;
      for (int c = 0; c < 3; ++c) {
        highest += std::min(down_[c] * water.region.lower[c], down_[c] * water.region.upper[c]);
      }
      surface_ = highest;
    }
  }
  [[nodiscard]] double pressure(const double* x, double density) const {
    if (norm_ == 0) return 0;
    const double along = down_[0] * x[0] + down_[1] * x[1] + down_[2] * x[2];
    return density * norm_ * std::max(0.0, along - surface_);
  }

 private:
  double norm_ = 0;
  double down_[3] = {0, 0, 0};
  double surface_ = 0;
};

/// The density ratio for the pressure of a row; beyond a tenth from rest the sound speed is too low for it.
double checked_density_ratio(const Scene& scene, const Constants& constants, const Water& water,
                             const WaterTable::Row& row) {
  const double s = density_ratio_of(row.pressure, constants);
  if (std::abs(s - 1) < 0.1) return s;
  throw coupling::InputError(fmt::format(
      "{}:{}: water.{}: {}:{}: the pressure {:g} Pa would change the density by more than a tenth at a sound speed of "
      "{:g} m/s; allowed: smaller pressures, or a larger numerics.sound_speed",
      scene.file.string(), water.line, water.name, water.table.file.filename().string(), row.line, row.pressure,
      constants.sound_speed));
}

/// Shares out the particles of the initial state: each rank takes every size-th row.
struct Share {
  int rank, size;
  std::int64_t row = 0;
  std::int64_t id = 0;
  [[nodiscard]] bool next_row_is_mine() { return row++ % size == rank; }
};

void fill_from_table(const Scene& scene, const Constants& constants, const Water& water, Share& share,
                     InitialParticles& result) {
  const Depth depth(scene, water);
  std::size_t within_walls = 0;
  for (const WaterTable::Row& row : water.table.rows) {
    const bool mine = share.next_row_is_mine();
    Traveller traveller;
    std::copy(row.position.begin(), row.position.end(), traveller.record.x);
    if (inside_box_wall(scene, traveller.record.x)) {
      ++within_walls;
      continue;
    }
    traveller.identity.id = share.id++;
    const double s = water.table.has_pressure ? checked_density_ratio(scene, constants, water, row) : 1.0;
    if (!mine) continue;
    const Vec3d& velocity = water.table.has_velocity ? row.velocity : water.velocity;
    std::copy(velocity.begin(), velocity.end(), traveller.record.v);
    traveller.record.p =
        water.table.has_pressure ? row.pressure : depth.pressure(traveller.record.x, constants.density);
    traveller.record.s = water.table.has_pressure ? s : density_ratio_of(traveller.record.p, constants);
    result.water.push_back(traveller);
  }
  if (within_walls > 0) {
    result.warnings.push_back(fmt::format("{}:{}: water '{}': {} of {} particles of the table lie in walls: left out",
                                          scene.file.filename().string(), water.line, water.name, within_walls,
                                          water.table.rows.size()));
  }
}

}  // namespace

InitialParticles fill(const Scene& scene, const Constants& constants, const Walls& walls, int rank, int size) {
  InitialParticles result;
  Share share{rank, size};
  for (const Water& water : scene.water) {
    if (water.kind == Water::Kind::table) {
      fill_from_table(scene, constants, water, share, result);
      continue;
    }
    std::vector<double> lattice[3] = {{0.0}, {0.0}, {0.0}};
    bool fits = true;
    for (int c = 0; c < scene.dimension; ++c) {
      double misfit = 0;
      lattice[c] = exact_lattice(water.region.lower[c], water.region.upper[c], constants.particle_distance, misfit);
      fits = fits && std::abs(misfit) < 0.02 * constants.particle_distance;
    }
    const std::size_t count = lattice[0].size() * lattice[1].size() * lattice[2].size();
    if (!fits) {
      double wanted = 1, got = 1;
      for (int c = 0; c < scene.dimension; ++c) {
        wanted *= water.region.upper[c] - water.region.lower[c];
        got *= constants.particle_distance * static_cast<double>(lattice[c].size());
      }
      result.warnings.push_back(fmt::format(
          "{}:{}: water '{}' is no multiple of the particle distance: volume {:+.1f} %", scene.file.filename().string(),
          water.line, water.name, wanted > 0 ? 100 * (got / wanted - 1) : 0.0));
    }
    if (count == 0) continue;
    const Depth depth(scene, water);
    for (const double z : lattice[2]) {
      for (const double y : lattice[1]) {
        const bool mine = share.next_row_is_mine();
        for (const double x : lattice[0]) {
          Traveller traveller;
          traveller.record = {{x, y, z}, {water.velocity[0], water.velocity[1], water.velocity[2]}, 0, 1};
          if (inside_box_wall(scene, traveller.record.x)) continue;
          traveller.identity.id = share.id++;
          if (!mine) continue;
          traveller.record.p = depth.pressure(traveller.record.x, constants.density);
          traveller.record.s = density_ratio_of(traveller.record.p, constants);
          result.water.push_back(traveller);
        }
      }
    }
  }
  result.walls = wall_points_of(walls, rank, size);
  return result;
}

std::vector<Traveller> wall_points_of(const Walls& walls, int rank, int size) {
  std::vector<Traveller> result;
  std::int64_t id = 0;
  for (int w = 0; w < walls.count(); ++w) {
    for (const Walls::Point& point : walls.points(w)) {
      const std::int64_t mine = id++;
      if (mine % size != rank) continue;
      Traveller traveller;
      std::copy(point.x.begin(), point.x.end(), traveller.record.x);
      traveller.identity = {mine, w, point.side};
      result.push_back(traveller);
    }
  }
  return result;
}

}  // namespace embacle::mps
