#include "core/filling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
    double norm = 0;
    for (const double g : scene.fluid.gravity) norm += g * g;
    norm_ = std::sqrt(norm);
    if (norm_ == 0) return;
    for (int c = 0; c < 3; ++c) down_[c] = scene.fluid.gravity[c] / norm_;
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

}  // namespace

InitialParticles fill(const Scene& scene, const Constants& constants, const Walls& walls, int rank, int size) {
  InitialParticles result;
  std::int64_t slice = 0;  // counts rows; each rank takes every size-th
  std::int64_t id = 0;
  for (const Water& water : scene.water) {
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
        const bool mine = slice++ % size == rank;
        for (const double x : lattice[0]) {
          Traveller traveller;
          traveller.record = {{x, y, z}, {water.velocity[0], water.velocity[1], water.velocity[2]}, 0, 1};
          if (inside_box_wall(scene, traveller.record.x)) continue;
          traveller.identity.id = id++;
          if (!mine) continue;
          traveller.record.p = depth.pressure(traveller.record.x, constants.density);
          traveller.record.s = density_ratio_of(traveller.record.p, constants);
          result.water.push_back(traveller);
        }
      }
    }
  }
  id = 0;
  for (int w = 0; w < walls.count(); ++w) {
    for (const Walls::Point& point : walls.points(w)) {
      if (slice++ % size != rank) {
        ++id;
        continue;
      }
      Traveller traveller;
      std::copy(point.x.begin(), point.x.end(), traveller.record.x);
      traveller.identity = {id++, w, point.side};
      result.walls.push_back(traveller);
    }
  }
  return result;
}

}  // namespace embacle::mps
