#include "core/guard.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::mps {

using coupling::Vec3;

namespace {

constexpr double guarded_distance = 0.3;  ///< in particle distances
/// Frequency of the spring, in c0/l0: stiff against any pressure of the flow, soft for the time step.
constexpr double spring_frequency = 0.2;

Vec3d axis_normal(int axis, double sign) {
  Vec3d normal{};
  normal[axis] = sign;
  return normal;
}

}  // namespace

Guard::Guard(const Scene& scene, const Constants& constants, const Walls& walls)
    : constants_(constants),
      walls_(walls),
      scene_(scene),
      distance_(guarded_distance * constants.particle_distance),
      stiffness_(std::pow(spring_frequency * constants.sound_speed / constants.particle_distance, 2)) {
  for (int w = 0; w < static_cast<int>(scene.walls.size()); ++w) {
    const Wall& wall = scene.walls[w];
    if (wall.kind != Wall::Kind::tank) {
      (wall.kind == Wall::Kind::box ? boxes_ : solids_).push_back(w);
      continue;
    }
    for (int axis = 0; axis < scene.dimension; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        const std::string name{"xyz"[axis], sign > 0 ? '-' : '+'};
        if (std::find(wall.open.begin(), wall.open.end(), name) != wall.open.end()) continue;
        faces_.push_back({w, axis, sign, sign > 0 ? wall.region.lower[axis] : wall.region.upper[axis]});
      }
    }
  }
}

double Guard::push(double distance, double approach) const {
  if (distance >= distance_) return 0;
  return stiffness_ * (distance_ - distance) + (approach < 0 ? -approach / constants_.step : 0.0);
}

void Guard::apply(const Particles& particles, const Neighbours& neighbours, const Bodies* bodies, double time,
                  double step, std::vector<Triple>& acceleration, Triple& wall_reaction,
                  std::vector<coupling::Load>& body_loads) const {
  struct Pose {
    Vec3d moved{}, velocity{};
  };
  std::vector<Pose> poses(scene_.walls.size());
  for (std::size_t w = 0; w < poses.size(); ++w) {
    const auto& motion = scene_.walls[w].motion;
    if (!motion || !motion->moves()) continue;
    poses[w].moved = displacement(*motion, time);
    const Vec3d before = displacement(*motion, time - step);
    for (int c = 0; c < 3; ++c) poses[w].velocity[c] = (poses[w].moved[c] - before[c]) / step;
  }
  const auto push_from_wall = [&](std::size_t i, const Vec3d& normal, double distance, double approach) {
    double value = push(distance, approach);
    // Whatever else acts on the particle, the next step must not end behind the wall.
    double outward = value;
    for (int c = 0; c < 3; ++c) outward += normal[c] * acceleration[i][c];
    const double next = distance + step * (approach + step * outward);
    if (next < 0) value -= next / (step * step);
    for (int c = 0; c < 3; ++c) {
      acceleration[i][c] += value * normal[c];
      wall_reaction[c] -= constants_.particle_mass * value * normal[c];
    }
  };
  for (std::size_t i = 0; i < particles.water; ++i) {
    const NeighbourRange range = neighbours.of_water(i);
    if (range.middle == range.end) continue;  // no solid near
    const Record& record = particles.record[i];
    for (std::size_t b = 0; bodies != nullptr && b < bodies->count(); ++b) {
      const Vec3 place(record.x[0], record.x[1], record.x[2]);
      const double distance = -bodies->depth_in(b, place);
      if (distance >= distance_) continue;
      const Vec3 normal = bodies->outward_normal(b, place);
      const auto& state = bodies->all()[b].state;
      const Vec3 surface = state.velocity + state.angular_velocity.cross(place - state.position);
      const Vec3 value = push(distance, normal.dot(Vec3(record.v[0], record.v[1], record.v[2]) - surface)) * normal;
      for (int c = 0; c < 3; ++c) acceleration[i][c] += value[c];
      const Vec3 force = -constants_.particle_mass * value;
      body_loads[b] += {force, (place - state.position).cross(force)};
    }
    // Walls last: nothing, not even a body, may press water through them.
    for (const Face& face : faces_) {
      const Pose& pose = poses[face.wall];
      const double distance = face.sign * (record.x[face.axis] - face.place - pose.moved[face.axis]);
      if (distance >= distance_ || distance < -constants_.support) continue;
      const double approach = face.sign * (record.v[face.axis] - pose.velocity[face.axis]);
      push_from_wall(i, axis_normal(face.axis, face.sign), distance, approach);
    }
    for (const int w : boxes_) {
      const BoxRegion& box = scene_.walls[w].region;
      // Nearest face of the box if the place is within reach of it, seen straight on.
      double nearest = -1e300, sign = 0;
      int axis = -1;
      for (int c = 0; c < scene_.dimension; ++c) {
        double x = record.x[c] - poses[w].moved[c];
        if (constants_.periodic.in(c)) {
          if (box.upper[c] - box.lower[c] > constants_.periodic.length[c] - distance_) continue;  // has no ends
          const double middle = 0.5 * (box.lower[c] + box.upper[c]);
          x = middle + constants_.periodic.nearest(c, x - middle);
        }
        const double below = box.lower[c] - x, above = x - box.upper[c];
        const double outside = std::max(below, above);
        if (outside > nearest) {
          nearest = outside;
          axis = c;
          sign = below > above ? -1.0 : 1.0;
        }
      }
      if (axis < 0 || nearest >= distance_) continue;
      const double approach = sign * (record.v[axis] - poses[w].velocity[axis]);
      push_from_wall(i, axis_normal(axis, sign), nearest, approach);
    }
    for (const int w : solids_) {
      const BoxRegion& region = scene_.walls[w].region;
      Vec3d place{}, normal{};
      bool near = true;
      for (int c = 0; c < scene_.dimension; ++c) {
        const double middle = 0.5 * (region.lower[c] + region.upper[c]);
        place[c] = middle + constants_.periodic.nearest(c, record.x[c] - poses[w].moved[c] - middle);
        near = near && place[c] > region.lower[c] - distance_ && place[c] < region.upper[c] + distance_;
      }
      if (!near) continue;
      const double distance = walls_.solid(w)->distance(place.data(), &normal);
      if (distance >= distance_) continue;
      double approach = 0;
      for (int c = 0; c < 3; ++c) approach += normal[c] * (record.v[c] - poses[w].velocity[c]);
      push_from_wall(i, normal, distance, approach);
    }
  }
}

}  // namespace embacle::mps
