// The wall points that Simulation keeps, and those of them that are among the particles: only what is near water.
#include <algorithm>

#include "core/simulation.hpp"

namespace embacle::mps {

void Simulation::adopt_walls(const std::vector<Traveller>& points) {
  std::vector<WallPoint> adopted(points.size());  // all at once: no larger than needed
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::copy_n(points[k].record.x, 3, adopted[k].at_zero);
    adopted[k].identity = points[k].identity;
  }
  wall_points_ = std::move(adopted);
  if (wall_density_) wall_density_->adopt(points);
}

/// Moves the stored wall points to where they are at `time`.
void Simulation::place_wall_points(double time) {
  if (!walls_.any_moves()) return;
  wall_pose_.resize(walls_.count());
  for (int w = 0; w < walls_.count(); ++w) wall_pose_[w] = walls_.course(w).pose(time);
}

/// A stored wall point at rest where it was at the last build.
Record Simulation::place_of(const WallPoint& point) const {
  Record record;
  std::copy_n(point.at_zero, 3, record.x);
  if (!wall_pose_.empty()) {
    const Vec3d place = wall_pose_[point.identity.owner].place({point.at_zero[0], point.at_zero[1], point.at_zero[2]});
    std::copy_n(place.data(), 3, record.x);
  }
  constants_.periodic.wrap(record.x);
  return record;
}

void Simulation::migrate_wall_points(double reach) {
  std::vector<Traveller> travellers(wall_points_.size());
  for (std::size_t k = 0; k < travellers.size(); ++k) {
    travellers[k] = {place_of(wall_points_[k]), wall_points_[k].identity};
    std::copy_n(wall_points_[k].at_zero, 3, travellers[k].record.v);
    if (wall_density_) travellers[k].record.s = wall_density_->of(k);
  }
  halo_.migrate(decomposition_, reach, anywhere_, travellers);
  std::sort(travellers.begin(), travellers.end(),  // the same order whatever way they came
            [](const Traveller& a, const Traveller& b) { return a.identity.id < b.identity.id; });
  for (Traveller& traveller : travellers) std::copy_n(traveller.record.v, 3, traveller.record.x);
  adopt_walls(travellers);
}

/// Copies of the stored wall points that water can feel, with the velocity of their wall.
std::vector<Traveller> Simulation::wall_points_near_water(double time) {
  const double before = time - constants_.step;
  const std::vector<Stride> strides = walls_.strides(before, before + constants_.step, constants_.step);
  std::vector<Traveller> result;
  for (std::size_t k = 0; k < wall_points_.size(); ++k) {
    const WallPoint& point = wall_points_[k];
    Record record = place_of(point);
    const bool near_water = neighbours_.near_water(record.x);
    if (wall_density_) record.s = wall_density_->pass(k, near_water);
    if (!near_water) continue;
    result.push_back({record, point.identity});
    const Vec3d velocity =
        strides[point.identity.owner].velocity_of({point.at_zero[0], point.at_zero[1], point.at_zero[2]});
    std::copy_n(velocity.data(), 3, result.back().record.v);
  }
  return result;
}

}  // namespace embacle::mps
