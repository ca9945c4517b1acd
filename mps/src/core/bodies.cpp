#include "core/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include "core/threads.hpp"

namespace embacle::mps {

using coupling::FluidBody;
using coupling::Load;
using coupling::Vec3;

namespace {

/// A number in [0, 1) for a place of the lattice, spread evenly over the places around (additive recurrence with the
/// powers of 1/g, g^4 = g + 1).
double evenly_spread(const double* x, double particle_distance) {
  constexpr double steps[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  double sum = 0.5;
  for (int c = 0; c < 3; ++c) sum += steps[c] * std::floor(x[c] / particle_distance);
  return sum - std::floor(sum);
}

/// Accelerations beyond this many g come from impacts shorter than the water resolves; the extrapolation leaves them
/// out.
constexpr double largest_acceleration_in_g = 2.0;

/// Of a body's face, in particle distances. Nearer ones are thrown off; farther ones press too little on thin plates
/// (docs/coupling.md).
constexpr double nearest_at_start = 0.35;

Vec3 limited(const Vec3& vector, double largest) {
  const double norm = vector.norm();
  return norm > largest ? Vec3(vector * (largest / norm)) : vector;
}

/// Angular acceleration [rad/s^2], global frame, from Euler's equation with principal moments.
Vec3 angular_acceleration(const coupling::State& state, const Vec3& moments, const Vec3& torque) {
  const Vec3 omega = state.orientation.conjugate() * state.angular_velocity;
  const Vec3 torque_body = state.orientation.conjugate() * torque;
  const Vec3 gyroscopic = omega.cross(moments.cwiseProduct(omega));
  return state.orientation * (torque_body - gyroscopic).cwiseQuotient(moments);
}

}  // namespace

Bodies::Bodies(const Constants& constants, const std::vector<coupling::Shape>& shapes, int first_owner)
    : constants_(constants),
      first_owner_(first_owner),
      gravity_(constants.gravity[0], constants.gravity[1], constants.gravity[2]) {
  for (const coupling::Shape& shape : shapes) {
    shapes_.push_back(
        {shape, shape.mass_properties(),
         shape.points(constants.particle_distance, constants.layers * constants.particle_distance, constants.dimension),
         shape.bounding_radius()});
  }
}

void Bodies::assign(const std::vector<FluidBody>& bodies) {
  const bool others = !std::ranges::equal(bodies_, bodies, {}, &FluidBody::tag, &FluidBody::tag);
  bodies_ = bodies;
  if (others) {  // the lists will be made anew; until then any of them may be near
    near_begin_.clear();
    water_nearby_.clear();
    near_.resize(count());
    std::iota(near_.begin(), near_.end(), 0);
  }
  acceleration_.assign(bodies_.size(), Vec3::Zero());
  angular_acceleration_.assign(bodies_.size(), Vec3::Zero());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const FluidBody& body = bodies_[b];
    if (body.applied.force.isZero()) continue;  // nothing known yet, or out of the water
    if (!left_out_.empty() && left_out_[body.shape]) continue;
    const auto& mass = shape_of(body).mass;
    const Vec3 force = body.applied.force + body.state.contact_force;
    const Vec3 torque = body.applied.torque + body.state.contact_torque;
    const double largest = largest_acceleration_in_g * gravity_.norm();
    acceleration_[b] = limited(force / mass.mass + gravity_, largest);
    angular_acceleration_[b] =
        limited(angular_acceleration(body.state, mass.inertia, torque), largest / shape_of(body).radius);
  }
}

void Bodies::collect_points(const Decomposition& decomposition, std::vector<Traveller>& points) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const FluidBody& body = bodies_[b];
    const ShapeData& shape = shape_of(body);
    if (decomposition.own().distance(body.state.position) > shape.radius) continue;
    for (std::size_t k = 0; k < shape.points.size(); ++k) {
      const Vec3 arm = body.state.orientation * shape.points[k].position;
      const Vec3 place = body.state.position + arm;
      if (!decomposition.owns(place.data())) continue;
      const Vec3 velocity = body.state.velocity + body.state.angular_velocity.cross(arm);
      Traveller traveller;
      for (int c = 0; c < 3; ++c) {
        traveller.record.x[c] = place[c];
        traveller.record.v[c] = velocity[c];
      }
      traveller.identity = {body.tag, first_owner_ + static_cast<std::int32_t>(b), static_cast<std::int32_t>(k)};
      points.push_back(traveller);
    }
  }
}

void Bodies::resolve_owners(Particles& particles) const {
  std::unordered_map<std::int64_t, std::int32_t> body_of_tag;
  for (std::size_t b = 0; b < bodies_.size(); ++b) body_of_tag[bodies_[b].tag] = static_cast<std::int32_t>(b);
  for (std::size_t j = particles.ghost_solid_begin(); j < particles.all(); ++j) {
    Identity& identity = particles.identity[j];
    if (identity.owner < first_owner_) continue;
    const auto body = body_of_tag.find(identity.id);
    if (body == body_of_tag.end()) throw std::logic_error("a neighbouring rank has points of a body unknown here");
    identity.owner = first_owner_ + body->second;
  }
}

void Bodies::drift(double step) {
  for (FluidBody& body : bodies_) {
    body.state.position += step * body.state.velocity;
    const double angle = body.state.angular_velocity.norm() * step;
    if (angle > 0) {
      const Eigen::AngleAxisd rotation(angle, body.state.angular_velocity.normalized());
      body.state.orientation = (coupling::Quaternion(rotation) * body.state.orientation).normalized();
    }
  }
}

void Bodies::place_points(Particles& particles) const {
  for (std::size_t j = particles.water; j < particles.own(); ++j) {
    const Identity& identity = particles.identity[j];
    if (identity.owner < first_owner_) continue;
    const FluidBody& body = bodies_[body_of(identity)];
    const Vec3 arm = body.state.orientation * shape_of(body).points[identity.point].position;
    const Vec3 velocity = body.state.velocity + body.state.angular_velocity.cross(arm);
    for (int c = 0; c < 3; ++c) {
      particles.record[j].x[c] = body.state.position[c] + arm[c];
      particles.record[j].v[c] = velocity[c];
    }
  }
}

void Bodies::point_accelerations(const Particles& particles, const Neighbours& neighbours,
                                 std::vector<Triple>& acceleration) const {
  const auto& wet = neighbours.wet_points();
  acceleration.assign(wet.size(), Triple{});
  for (std::size_t k = 0; k < wet.size(); ++k) {
    const Identity& identity = particles.identity[wet[k]];
    if (identity.owner < first_owner_) continue;
    const std::size_t b = body_of(identity);
    const coupling::State& state = bodies_[b].state;
    const double* x = particles.record[wet[k]].x;
    const Vec3 arm = Vec3(x[0], x[1], x[2]) - state.position;
    const Vec3 value = acceleration_[b] + angular_acceleration_[b].cross(arm) +
                       state.angular_velocity.cross(state.angular_velocity.cross(arm));
    acceleration[k] = {value[0], value[1], value[2]};
  }
}

std::vector<Load> Bodies::partial_loads(const Particles& particles, const std::vector<Triple>& reaction) const {
  std::vector<Load> loads(bodies_.size());
  const auto add = [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) {
      const Identity& identity = particles.identity[j];
      if (identity.owner < first_owner_) continue;
      const Triple& f = reaction[reaction_slot(particles, j)];
      const Vec3 force(f[0], f[1], f[2]);
      const double* x = particles.record[j].x;
      const std::size_t b = body_of(identity);
      loads[b].force += force;
      loads[b].torque += (Vec3(x[0], x[1], x[2]) - bodies_[b].state.position).cross(force);
    }
  };
  add(particles.water, particles.own());
  add(particles.ghost_solid_begin(), particles.all());
  return loads;
}

void Bodies::predict(std::span<const Load> total, double step) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    coupling::State& state = bodies_[b].state;
    const auto& mass = shape_of(bodies_[b]).mass;
    state.velocity += step * ((total[b].force + state.contact_force) / mass.mass + gravity_);
    state.angular_velocity += step * angular_acceleration(state, mass.inertia, total[b].torque + state.contact_torque);
  }
}

Eigen::Matrix<double, 6, 1> Bodies::push_without_load(std::size_t body) const {
  const coupling::State& state = bodies_[body].state;
  const Vec3 omega = state.orientation.conjugate() * state.angular_velocity;
  const Vec3 gyroscopic = state.orientation * omega.cross(mass(body).inertia.cwiseProduct(omega));
  Eigen::Matrix<double, 6, 1> result;
  result << state.contact_force + mass(body).mass * gravity_, state.contact_torque - gyroscopic;
  return result;
}

Bodies::Energy Bodies::energy(int rank) const {
  Energy sum;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!speaks_for(rank, bodies_[b])) continue;
    const coupling::State& state = bodies_[b].state;
    const Vec3 omega = state.orientation.conjugate() * state.angular_velocity;
    sum.kinetic +=
        0.5 * mass(b).mass * state.velocity.squaredNorm() + 0.5 * omega.dot(mass(b).inertia.cwiseProduct(omega));
    sum.potential -= mass(b).mass * gravity_.dot(state.position);
  }
  return sum;
}

double Bodies::work_of_contacts(const std::vector<coupling::FluidBody>& before, double length, int rank) const {
  double work = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!speaks_for(rank, bodies_[b])) continue;
    const coupling::State &start = before[b].state, &end = bodies_[b].state;
    work += 0.5 * length *
            (end.contact_force.dot(start.velocity + end.velocity) +
             end.contact_torque.dot(start.angular_velocity + end.angular_velocity));
  }
  return work;
}

double Bodies::depth_in(std::size_t body, const Vec3& place) const {
  const coupling::State& state = bodies_[body].state;
  const ShapeData& data = shape_of(bodies_[body]);
  const Vec3 arm = place - state.position;
  const double far = data.radius + constants_.support;
  if (arm.squaredNorm() > far * far) return -constants_.support;
  return -data.shape.signed_distance(state.orientation.conjugate() * arm);
}

Vec3 Bodies::outward_normal(std::size_t body, const Vec3& place) const {
  const coupling::State& state = bodies_[body].state;
  const coupling::Shape& shape = shape_of(bodies_[body]).shape;
  const Vec3 local = state.orientation.conjugate() * (place - state.position);
  const double h = 1e-4 * constants_.particle_distance;
  Vec3 slope;
  for (int c = 0; c < 3; ++c) {
    const Vec3 offset = h * Vec3::Unit(c);
    slope[c] = shape.signed_distance(local + offset) - shape.signed_distance(local - offset);
  }
  if (constants_.dimension == 2) slope[2] = 0;
  return state.orientation * slope.normalized();
}

void Bodies::note_water_nearby(const Particles& particles, const Neighbours& neighbours) {
  constexpr std::size_t few = 8;
  struct Found {
    std::vector<std::uint32_t> water, count, bodies;
  };
  std::vector<Found> parts(threads());
  in_parallel(particles.water, [&](std::size_t first, std::size_t last, int thread) {
    Found& part = parts[thread];
    std::vector<std::uint32_t> found;
    for (std::size_t i = first; i < last; ++i) {
      const NeighbourRange range = neighbours.of_water(i);
      found.clear();
      for (auto k = range.middle; k < range.end && *k != particles.sentinel(); ++k) {
        const Identity& identity = particles.identity[*k];
        if (identity.owner < first_owner_) continue;
        const auto b = static_cast<std::uint32_t>(body_of(identity));
        if (std::ranges::find(found, b) == found.end()) found.push_back(b);
      }
      if (found.empty()) continue;
      std::ranges::sort(found);
      part.water.push_back(static_cast<std::uint32_t>(i));
      part.count.push_back(static_cast<std::uint32_t>(found.size()));
      part.bodies.insert(part.bodies.end(), found.begin(), found.end());
    }
  });
  water_nearby_.clear();
  near_begin_.clear();
  if (count() > few) {
    near_begin_.assign(particles.water + 1, 0);
    near_.clear();
  } else {
    near_.resize(count());
    std::iota(near_.begin(), near_.end(), 0);
  }
  for (const Found& part : parts) {
    water_nearby_.insert(water_nearby_.end(), part.water.begin(), part.water.end());
    if (near_begin_.empty()) continue;
    near_.insert(near_.end(), part.bodies.begin(), part.bodies.end());
    for (std::size_t k = 0; k < part.water.size(); ++k) near_begin_[part.water[k] + 1] = part.count[k];
  }
  std::partial_sum(near_begin_.begin(), near_begin_.end(), near_begin_.begin());
}

std::span<const std::uint32_t> Bodies::near(std::size_t water) const {
  if (near_begin_.empty()) return near_;
  return std::span(near_).subspan(near_begin_[water], near_begin_[water + 1] - near_begin_[water]);
}

double Bodies::penetration(const double* x) const {
  double deepest = -constants_.support;
  for (std::size_t b = 0; b < count(); ++b) deepest = std::max(deepest, depth_in(b, Vec3(x[0], x[1], x[2])));
  return deepest;
}

// A particle fills one particle distance across a face, so one whose centre is nearer to it than half of that is in
// part displaced. That part of all such particles is left out, evenly over the face, so that the water left has the
// right volume everywhere; continuity would never mend a layer too much or too little.
bool Bodies::make_room(double* x, std::int64_t newer_than) const {
  const double l0 = constants_.particle_distance;
  const auto depth = [&](std::size_t b) { return depth_in(b, Vec3(x[0], x[1], x[2])); };
  bool concerned = false;
  for (std::size_t b = 0; b < count() && !concerned; ++b) {
    concerned = bodies_[b].tag > newer_than && depth(b) > -0.5 * l0;
  }
  if (!concerned) return true;
  for (std::size_t b = 0; b < count(); ++b) {
    const double gap = -depth(b) / l0;
    if (gap < 0.5 - 1e-6 && !(evenly_spread(x, l0) < 0.5 + gap)) return false;
  }
  int close = 0;  // a gap between two bodies may be too narrow for a particle
  for (std::size_t b = 0; b < count(); ++b) {
    const double lacking = nearest_at_start * l0 + depth(b);
    if (lacking <= 0) continue;
    const Vec3 normal = outward_normal(b, Vec3(x[0], x[1], x[2]));
    for (int c = 0; c < constants_.dimension; ++c) x[c] += lacking * normal[c];
  }
  for (std::size_t b = 0; b < count(); ++b) {
    if (depth(b) > 0) return false;
    close += depth(b) > -0.45 * l0 ? 1 : 0;
  }
  return close < 2;
}

std::vector<coupling::BodyPressures> Bodies::surface_pressures(const Particles& particles) const {
  std::vector<coupling::BodyPressures> result(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) result[b].tag = bodies_[b].tag;
  for (std::size_t j = particles.water; j < particles.own(); ++j) {
    const Identity& identity = particles.identity[j];
    if (identity.owner < first_owner_) continue;
    const std::size_t b = body_of(identity);
    if (!shape_of(bodies_[b]).points[identity.point].on_surface()) continue;
    result[b].point.push_back(identity.point);
    result[b].pressure.push_back(particles.record[j].p);
  }
  return result;
}

std::vector<coupling::Shape> Bodies::shapes() const {
  std::vector<coupling::Shape> result;
  for (const ShapeData& data : shapes_) result.push_back(data.shape);
  return result;
}

double Bodies::fastest() const {
  double result = 0;
  for (const auto& body : bodies_) {
    result = std::max(result, body.state.velocity.norm() + body.state.angular_velocity.norm() * shape_of(body).radius);
  }
  return result;
}

std::size_t Bodies::bytes() const {
  std::size_t total = bodies_.capacity() * sizeof(FluidBody);
  for (const ShapeData& shape : shapes_) total += shape.points.capacity() * sizeof(coupling::ShapePoint);
  return total;
}

}  // namespace embacle::mps
