#include "core/guard.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::mps {

using coupling::Load;
using coupling::Vec3;

namespace {

constexpr double guarded_distance = 0.3;  ///< in particle distances
/// Frequency of the spring, in c0/l0: stiff against any pressure of the flow, soft for the time step.
constexpr double spring_frequency = 0.2;
/// What the next step must leave between water and surface, in particle distances: what a body moves in one step after
/// a blow that the water did not know of.
constexpr double clearance = 0.02;
/// Outward speed, in c0, above which the guard pushes no more: water that a solid overran leaves it within some steps
/// (20 a spacing) instead of being shot out in one.
constexpr double leaving_speed = 0.05;
constexpr int turns = 4;

Vec3d axis_normal(int axis, double sign) {
  Vec3d normal{};
  normal[axis] = sign;
  return normal;
}

double square_distance(const Vec3d& a, const Vec3d& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

}  // namespace

Guard::Guard(const Scene& scene, const Constants& constants, const Walls& walls)
    : constants_(constants),
      walls_(walls),
      scene_(scene),
      distance_(guarded_distance * constants.particle_distance),
      clearance_(clearance * constants.particle_distance),
      leaving_speed_(leaving_speed * constants.sound_speed),
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

void Guard::hold_outside(std::vector<Contact>& contacts, Triple& acceleration, double step) const {
  const auto velocity_after = [&](const Contact& contact) {  // outward, relative to the surface
    double outward = 0;
    for (int c = 0; c < 3; ++c) outward += contact.normal[c] * acceleration[c];
    return contact.approach + step * outward;
  };
  const auto add = [&](Contact& contact, double value) {
    contact.push += value;
    for (int c = 0; c < 3; ++c) acceleration[c] += value * contact.normal[c];
  };
  for (Contact& contact : contacts) {
    const double value = std::min(contact.push, (leaving_speed_ - velocity_after(contact)) / step);
    contact.push = 0;
    if (value > 0) add(contact, value);
  }
  // Between two solids each pushes the water towards the other: the corrections take turns, the walls last.
  for (int turn = 0; turn < turns; ++turn) {
    bool held = true;
    for (Contact& contact : contacts) {
      const double needed = std::min((clearance_ - contact.distance) / step, leaving_speed_);
      const double velocity = velocity_after(contact);
      if (velocity >= needed) continue;
      add(contact, (needed - velocity) / step);
      held = false;
    }
    if (held) return;
  }
}

void Guard::apply(const Particles& particles, const Neighbours& neighbours, const Bodies* bodies, double time,
                  double step, std::vector<Triple>& acceleration, std::vector<coupling::Load>& wall_loads,
                  std::vector<coupling::Load>& body_loads) {
  const std::vector<Stride> strides = walls_.strides(time - step, time, step);
  const int first_body = walls_.count();
  loads_.reset(first_body + (bodies != nullptr ? bodies->count() : 0));
  stored_.reset(1);
  std::vector<std::vector<Contact>> contacts_of_thread(threads());
  for_each(particles.water, [&](std::size_t i, int thread) {
    const NeighbourRange range = neighbours.of_water(i);
    if (range.middle == range.end) return;  // no solid near
    const Record& record = particles.record[i];
    std::vector<Contact>& contacts = contacts_of_thread[thread];  // bodies first, then walls
    contacts.clear();
    const auto add = [&](int solid, const Vec3d& normal, double distance, const Vec3d& velocity) {
      double approach = 0;
      for (int c = 0; c < 3; ++c) approach += normal[c] * (record.v[c] - velocity[c]);
      contacts.push_back({solid, normal, distance, approach, push(distance, approach)});
    };
    const Vec3 place(record.x[0], record.x[1], record.x[2]);
    for (const std::uint32_t b : bodies != nullptr ? bodies->near(i) : std::span<const std::uint32_t>()) {
      const double distance = -bodies->depth_in(b, place);
      if (distance >= distance_) continue;
      const Vec3 normal = bodies->outward_normal(b, place);
      const auto& state = bodies->all()[b].state;
      const Vec3 surface = state.velocity + state.angular_velocity.cross(place - state.position);
      add(first_body + static_cast<int>(b), {normal[0], normal[1], normal[2]}, distance,
          {surface[0], surface[1], surface[2]});
    }
    for (const Face& face : faces_) {
      const Stride& stride = strides[face.wall];
      const Pose& pose = stride.after;
      if (pose.turned) {
        const Vec3d zero = pose.zero({record.x[0], record.x[1], record.x[2]});
        const double distance = face.sign * (zero[face.axis] - face.place);
        if (distance >= distance_ || distance < -constants_.support) continue;
        add(face.wall, pose.turn(axis_normal(face.axis, face.sign)), distance, stride.velocity_of(zero));
        continue;
      }
      const double distance = face.sign * (record.x[face.axis] - face.place - pose.moved[face.axis]);
      if (distance >= distance_ || distance < -constants_.support) continue;
      add(face.wall, axis_normal(face.axis, face.sign), distance, stride.velocity);
    }
    for (const int w : boxes_) {
      const BoxRegion& box = scene_.walls[w].region;
      // Nearest face of the box if the place is within reach of it, seen straight on.
      double nearest = -1e300, sign = 0;
      int axis = -1;
      const Vec3d zero = strides[w].after.zero({record.x[0], record.x[1], record.x[2]});
      for (int c = 0; c < scene_.dimension; ++c) {
        double x = zero[c];
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
      add(w, strides[w].after.turn(axis_normal(axis, sign)), nearest, strides[w].velocity_of(zero));
    }
    for (std::size_t k = 0; k < solids_.size(); ++k) {
      const int w = solids_[k];
      const BoxRegion& region = scene_.walls[w].region;
      const Vec3d zero = strides[w].after.zero({record.x[0], record.x[1], record.x[2]});
      Vec3d local{}, normal{};
      bool close = true;
      for (int c = 0; c < scene_.dimension; ++c) {
        const double middle = 0.5 * (region.lower[c] + region.upper[c]);
        local[c] = middle + constants_.periodic.nearest(c, zero[c] - middle);
        close = close && local[c] > region.lower[c] - distance_ && local[c] < region.upper[c] + distance_;
      }
      if (!close) continue;
      Seen& seen = seen_[solids_.size() * i + k];
      const double lacks = seen.distance - distance_;
      if (lacks > 0 && square_distance(local, seen.place) < lacks * lacks) continue;
      const double distance = walls_.solid(w)->distance(local.data(), &normal);
      seen = {local, distance};
      if (distance >= distance_) continue;
      add(w, strides[w].after.turn(normal), distance, strides[w].velocity_of(zero));
    }
    if (contacts.empty()) return;

    hold_outside(contacts, acceleration[i], step);
    Load* const loads = loads_.of_thread(thread);
    for (const Contact& contact : contacts) {
      const double pressed = std::max(0.0, distance_ - contact.distance);
      *stored_.of_thread(thread) += 0.5 * constants_.particle_mass * stiffness_ * pressed * pressed;
      Vec3 force;  // on the solid
      for (int c = 0; c < 3; ++c) force[c] = -constants_.particle_mass * contact.push * contact.normal[c];
      const bool wall = contact.solid < first_body;
      const Vec3 arm = wall ? place : Vec3(place - bodies->all()[contact.solid - first_body].state.position);
      loads[contact.solid] += {force, arm.cross(force)};
    }
  });
  loads_.join();
  stored_.join();
  const std::vector<Load>& total = loads_.total();
  wall_loads.assign(total.begin(), total.begin() + first_body);
  for (std::size_t b = first_body; b < total.size(); ++b) body_loads[b - first_body] += total[b];
}

}  // namespace embacle::mps
