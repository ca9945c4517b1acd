#include "core/filling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

/// Inside of a wall other than a tank.
bool inside_wall(const Scene& scene, const Walls& walls, const double* x) {
  for (int w = 0; w < walls.count(); ++w) {
    const Wall& wall = scene.walls[w];
    if (wall.kind == Wall::Kind::tank) continue;
    bool inside = true;
    for (int c = 0; c < scene.dimension; ++c) {
      inside = inside && x[c] > wall.region.lower[c] && x[c] < wall.region.upper[c];
    }
    if (inside && (walls.solid(w) == nullptr || walls.solid(w)->distance(x) < 0)) return true;
  }
  return false;
}

/// Moves a site that is less than half a particle distance from a wall of other form than a box out to that distance.
void keep_off(const Walls& walls, double spacing, double* x) {
  for (int w = 0; w < walls.count(); ++w) {
    if (walls.solid(w) == nullptr) continue;
    Vec3d normal{};
    const double distance = walls.solid(w)->distance(x, &normal);
    if (distance >= 0.5 * spacing) continue;
    for (int c = 0; c < 3; ++c) x[c] += (0.5 * spacing - distance) * normal[c];
  }
}

/// Beyond a closed side of a tank.
bool outside_tank(const Scene& scene, const double* x) {
  return std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Wall& wall) {
    if (wall.kind != Wall::Kind::tank) return false;
    const auto closed = [&](int c, char sign) {
      return std::find(wall.open.begin(), wall.open.end(), std::string{"xyz"[c], sign}) == wall.open.end();
    };
    for (int c = 0; c < scene.dimension; ++c) {
      if ((x[c] < wall.region.lower[c] && closed(c, '-')) || (x[c] > wall.region.upper[c] && closed(c, '+')))
        return true;
    }
    return false;
  });
}

/// The sites of a lattice that water takes: those in its form and in no wall, and with a place to fill from only those
/// connected with it.
class Sites {
 public:
  Sites(const Scene& scene, const Walls& walls, const Water& water, const std::vector<double> (&lattice)[3])
      : nx_(lattice[0].size()), ny_(lattice[1].size()) {
    std::optional<Solid> form;
    if (water.form.kind != Form::Kind::none) form.emplace(water.form, scene.dimension);
    taken_.reserve(nx_ * ny_ * lattice[2].size());
    for (const double z : lattice[2]) {
      for (const double y : lattice[1]) {
        for (const double x : lattice[0]) {
          const double place[3] = {x, y, z};
          const bool in_form = !form || form->distance(place) < 0;
          in_form_ += in_form ? 1 : 0;
          const bool inside = in_form && !inside_wall(scene, walls, place);
          taken_.push_back(inside && !(water.fill_from && outside_tank(scene, place)) ? 1 : 0);
        }
      }
    }
    if (form) misfit_ = in_form_ * std::pow(scene.numerics.particle_distance, scene.dimension) / form->volume() - 1;
    if (water.fill_from) keep_connected(scene, water, lattice);
  }
  [[nodiscard]] bool taken(std::size_t site) const { return taken_[site] != 0; }
  /// By how much of its volume the lattice exceeds the form.
  [[nodiscard]] double misfit() const { return misfit_; }

 private:
  void keep_connected(const Scene& scene, const Water& water, const std::vector<double> (&lattice)[3]) {
    const double l0 = scene.numerics.particle_distance;
    std::size_t at[3] = {0, 0, 0};
    bool found = !taken_.empty();
    for (int c = 0; found && c < scene.dimension; ++c) {
      const double offset = ((*water.fill_from)[c] - lattice[c].front()) / l0 + 0.5;
      found = offset >= 0 && offset < static_cast<double>(lattice[c].size());
      if (found) at[c] = static_cast<std::size_t>(offset);
    }
    const std::size_t seed = (at[2] * ny_ + at[1]) * nx_ + at[0];
    if (!found || taken_[seed] == 0) {
      throw coupling::InputError(
          fmt::format("{}:{}: water.{}.fill_from: there is no room for water at this place; allowed: a "
                      "place within its box or form, and in no wall",
                      scene.file.string(), water.line, water.name));
    }
    std::vector<char> reached(taken_.size(), 0);
    std::vector<std::size_t> open{seed};
    reached[seed] = 1;
    const std::size_t slice = nx_ * ny_;
    while (!open.empty()) {
      const std::size_t site = open.back();
      open.pop_back();
      const auto visit = [&](bool there, std::size_t other) {
        if (!there || taken_[other] == 0 || reached[other] != 0) return;
        reached[other] = 1;
        open.push_back(other);
      };
      const std::size_t x = site % nx_, y = site % slice / nx_;
      visit(x > 0, site - 1);
      visit(x + 1 < nx_, site + 1);
      visit(y > 0, site - nx_);
      visit(y + 1 < ny_, site + nx_);
      visit(site >= slice, site - slice);
      visit(site + slice < taken_.size(), site + slice);
    }
    taken_ = std::move(reached);
  }

  std::size_t nx_, ny_;
  std::vector<char> taken_;
  double in_form_ = 0;
  double misfit_ = 0;
};

/// Lattice of the particle distance about the middle of a form, wide enough for it.
std::vector<double> centred_lattice(double lower, double upper, double spacing) {
  const int n = std::max(1, static_cast<int>(std::ceil((upper - lower) / spacing - 1e-6)));
  std::vector<double> centres(n);
  for (int i = 0; i < n; ++i) centres[i] = 0.5 * (lower + upper) + (i + 0.5 - 0.5 * n) * spacing;
  return centres;
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

void fill_from_table(const Scene& scene, const Constants& constants, const Walls& walls, const Water& water,
                     Share& share, InitialParticles& result) {
  const Depth depth(scene, water);
  std::size_t within_walls = 0;
  for (const WaterTable::Row& row : water.table.rows) {
    const bool mine = share.next_row_is_mine();
    Traveller traveller;
    std::copy(row.position.begin(), row.position.end(), traveller.record.x);
    if (inside_wall(scene, walls, traveller.record.x)) {
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
      fill_from_table(scene, constants, walls, water, share, result);
      continue;
    }
    std::vector<double> lattice[3] = {{0.0}, {0.0}, {0.0}};
    bool fits = true;
    for (int c = 0; c < scene.dimension; ++c) {
      double misfit = 0;
      if (water.form.kind != Form::Kind::none) {
        lattice[c] = centred_lattice(water.region.lower[c], water.region.upper[c], constants.particle_distance);
        continue;
      }
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
    const Sites sites(scene, walls, water, lattice);
    if (std::abs(sites.misfit()) > 0.02) {
      result.warnings.push_back(fmt::format("{}:{}: water '{}' is coarse for its form: volume {:+.1f} %",
                                            scene.file.filename().string(), water.line, water.name,
                                            100 * sites.misfit()));
    }
    std::size_t site = 0;
    for (const double z : lattice[2]) {
      for (const double y : lattice[1]) {
        const bool mine = share.next_row_is_mine();
        for (const double x : lattice[0]) {
          Traveller traveller;
          traveller.record = {{x, y, z}, {water.velocity[0], water.velocity[1], water.velocity[2]}, 0, 1};
          if (!sites.taken(site++)) continue;
          traveller.identity.id = share.id++;
          if (!mine) continue;
          keep_off(walls, constants.particle_distance, traveller.record.x);
          traveller.record.p = depth.pressure(traveller.record.x, constants.density);
          traveller.record.s = density_ratio_of(traveller.record.p, constants);
          result.water.push_back(traveller);
        }
      }
    }
  }
  result.next_id = share.id;
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

bool near_wall(const Scene& scene, const Walls& walls, const double* x, double clearance) {
  for (int c = 0; c < scene.dimension; ++c) {
    for (const double offset : {-clearance, clearance}) {
      double place[3] = {x[0], x[1], x[2]};
      place[c] += offset;
      if (inside_wall(scene, walls, place) || outside_tank(scene, place)) return true;
    }
  }
  return false;
}

}  // namespace embacle::mps
