#include "contact/floe_contacts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contact/near_pairs.hpp"
#include "contact/stored_energy.hpp"
#include "fix_floe_create.hpp"
#include "stock_access.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::BodyTag;
using coupling::InputError;
using coupling::Mat3;
using coupling::Vec3;

namespace {

constexpr int state_size = 14;  // position, orientation, velocity, angular velocity, contacts

FixPropertyGlobal* find_property(LAMMPS* lammps, const char* name, const char* kind) {
  const int types = lammps->atom->ntypes;
  const bool pairwise = std::string(kind) == "peratomtypepair";
  auto* found = static_cast<FixPropertyGlobal*>(lammps->modify->find_fix_property(
      name, "property/global", kind, types, pairwise ? types : 0, "model floe", false));
  if (!found) {
    throw InputError(fmt::format("{}: needs 'fix ID all property/global {} {} ...'", floe_model_name, name, kind));
  }
  return found;
}

/// A triangle of a mesh relative to an origin [m].
coupling::Triangle mesh_triangle(TriMesh* mesh, int number, const Vec3& origin) {
  coupling::Triangle triangle;
  for (int k = 0; k < 3; ++k) {
    mesh->node(number, k, triangle[k].data());
    triangle[k] -= origin;
  }
  return triangle;
}

/// The direction +x, -x, ... -z that is nearest to a vector.
int main_direction(const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return 2 * axis + (normal[axis] < 0 ? 1 : 0);
}

double in_springs(const ContactMemory& memory) {
  if (memory.touching == 0) return 0;
  double energy = 0;
  if (memory.spring_stiffness > 0) {
    for (const double part : memory.spring) energy += 0.5 * part * part / memory.spring_stiffness;
  }
  if (memory.twist_stiffness > 0) energy += 0.5 * memory.twist * memory.twist / memory.twist_stiffness;
  return energy;
}

}  // namespace

void FloeContacts::prepare() {
  multisphere_ = find_multisphere(lammps_, floe_model_name);
  if (!(lammps_->update->dt > 0)) {
    throw InputError(fmt::format("{}: the time step must be positive, not {} s", floe_model_name, lammps_->update->dt));
  }
  const auto shapes = floe_shapes(lammps_);
  materials_.clear();
  const int types = lammps_->atom->ntypes;
  FixPropertyGlobal* young = find_property(lammps_, "youngsModulus", "peratomtype");
  FixPropertyGlobal* poisson = find_property(lammps_, "poissonsRatio", "peratomtype");
  FixPropertyGlobal* restitution = find_property(lammps_, "coefficientRestitution", "peratomtypepair");
  FixPropertyGlobal* friction = find_property(lammps_, "coefficientFriction", "peratomtypepair");
  young_.assign(young->get_values(), young->get_values() + types);
  contact_materials_.assign(types, std::vector<ContactMaterial>(types));
  for (int i = 0; i < types; ++i) {
    if (!(young_[i] > 0))
      throw InputError(fmt::format("{}: youngsModulus of type {} must be positive", floe_model_name, i + 1));
    for (int j = 0; j < types; ++j) {
      const double e = restitution->compute_array(i, j), mu = friction->compute_array(i, j);
      if (!(e >= 0 && e <= 1 && mu >= 0)) {
        throw InputError(fmt::format(
            "{}: coefficientRestitution {} or coefficientFriction {} of the types {} and {} is out of range: "
            "allowed are 0 to 1, and 0 or more",
            floe_model_name, e, mu, i + 1, j + 1));
      }
      if (e < least_restitution && j <= i && lammps_->comm->me == 0) {
        lammps_->error->warning(FLERR, fmt::format("{}: coefficientRestitution {} of the types {} and {} acts as {}",
                                                   floe_model_name, e, i + 1, j + 1, least_restitution)
                                           .c_str());
      }
      contact_materials_[i][j] =
          ContactMaterial::with(e, mu, 0.5 * (poisson->get_values()[i] + poisson->get_values()[j]));
    }
  }
  for (const FloeShape* shape : shapes) {
    Material material;
    material.shape = convex_shape(shape->shape, floe_model_name);
    material.atom_type = shape->atom_type;
    // Pressed between two plates, a body of this thickness yields as its modulus asks.
    material.hardness = young_[shape->atom_type - 1] / material.shape.thickness;
    const auto properties = shape->shape.mass_properties();
    material.mass = properties.mass;
    material.inertia = properties.inertia;
    for (const auto& face : material.shape.faces) material.face = std::max(material.face, face.area);
    materials_.push_back(std::move(material));
  }
  thinnest_ = std::numeric_limits<double>::infinity();
  for (const Material& of : materials_) thinnest_ = std::min(thinnest_, of.shape.thickness);
  find_walls();
  wall_impulses_.resize(walls_.size());
  built_ = -1;
}

void FloeContacts::find_walls() {
  walls_.clear();
  for (int f = 0; f < lammps_->modify->nfix; ++f) {
    auto* fix = dynamic_cast<FixWallGran*>(lammps_->modify->fix[f]);
    if (!fix || !fix->contact_match("model", "floe")) continue;
    Wall wall;
    wall.fix = fix;
    if (fix->is_mesh_wall()) {
      for (int m = 0; m < fix->n_meshes(); ++m) {
        wall.mesh = fix->mesh_list()[m];
        wall.atom_type = wall.mesh->atomTypeWall();
        walls_.push_back(wall);
      }
      continue;
    }
    const PrimitivePlane plane = primitive_plane(fix);
    if (plane.axis < 0) {
      throw InputError(
          fmt::format("fix {} wall/gran: model floe has planes (xplane, yplane, zplane) and meshes; "
                      "give a cylinder as a mesh",
                      fix->id));
    }
    wall.axis = plane.axis;
    wall.place = plane.place;
    wall.velocity = plane.velocity;
    wall.atom_type = fix->atom_type_wall();
    walls_.push_back(wall);
  }
}

double FloeContacts::wall_share(int body_type, int wall_type) const {
  // The wall yields like a body of the same thickness of its own material.
  return young_[wall_type - 1] / (young_[body_type - 1] + young_[wall_type - 1]);
}

Vec3 FloeContacts::nearest_image(Vec3 difference) const {
  const Domain* domain = lammps_->domain;
  const Vec3 period(domain->xprd, domain->yprd, domain->zprd);
  for (int k = 0; k < 3; ++k) {
    if (domain->periodicity[k]) difference[k] -= period[k] * std::round(difference[k] / period[k]);
  }
  return difference;
}

void FloeContacts::find_owned() {
  Multisphere& bodies = multisphere_->data();
  auto* types = bodies.prop().getElementProperty<ScalarContainer<int>>("clumptype");
  int rank = 0;
  MPI_Comm_rank(lammps_->world, &rank);
  bodies_.clear();
  for (int i = 0; i < bodies.n_body(); ++i) {
    Body body;
    body.tag = bodies.tag(i);
    body.shape = (*types)(i)-first_floe_type;
    body.owner = rank;
    body.local = i;
    if (body.shape < 0 || body.shape >= static_cast<int>(materials_.size())) {
      throw InputError(fmt::format("{}: the shape of body {} is not known; bodies come from fix floe/create",
                                   floe_model_name, body.tag));
    }
    bodies_.push_back(body);
  }
  std::sort(bodies_.begin(), bodies_.end(), [](const Body& a, const Body& b) { return a.tag < b.tag; });
  owned_ = bodies_.size();
}

void FloeContacts::refresh() {
  Multisphere& bodies = multisphere_->data();
  for (std::size_t b = 0; b < owned_; ++b) {
    Body& body = bodies_[b];
    bodies.xcm(body.motion.position.data(), body.local);
    bodies.vcm(body.motion.velocity.data(), body.local);
    bodies.omega(body.motion.angular_velocity.data(), body.local);
    std::array<double, 4> q{};
    bodies.quat(q.data(), body.local);
    body.orientation = coupling::Quaternion(q[0], q[1], q[2], q[3]);
  }
  count_contacts();
  share_states();
  for (Body& body : bodies_) {
    const double reach = materials_[body.shape].shape.reach;
    body.fastest = body.motion.velocity.norm() + body.motion.angular_velocity.norm() * reach;
    body.turned = false;
  }
}

void FloeContacts::turn(Body& body) const {
  if (body.turned) return;
  const Material& of = materials_[body.shape];
  body.axes = body.orientation.toRotationMatrix();
  body.motion.inverse_mass = 1 / of.mass;
  body.motion.inverse_inertia = body.axes * of.inertia.cwiseInverse().asDiagonal() * body.axes.transpose();
  body.turned = true;
}

void FloeContacts::count_contacts() {
  for (std::size_t b = 0; b < owned_; ++b) bodies_[b].contacts = 0;
  for (const Pair& pair : pairs_) {
    bodies_[pair.first].contacts += pair.memory.touching;
    bodies_[pair.second].contacts += pair.memory.touching;
  }
  for (const WallPair& pair : wall_pairs_) {
    for (const ContactMemory& memory : pair.memory) bodies_[pair.body].contacts += memory.touching;
  }
}

void FloeContacts::share_states() {
  std::vector<MPI_Request> requests;
  for (Exchange& exchange : exchanges_) {
    exchange.received.resize(exchange.receive.size() * state_size);
    exchange.sent.clear();
    for (const int b : exchange.send) {
      const Body& body = bodies_[b];
      for (const auto* vector : {&body.motion.position, &body.motion.velocity, &body.motion.angular_velocity}) {
        exchange.sent.insert(exchange.sent.end(), vector->data(), vector->data() + 3);
      }
      exchange.sent.insert(exchange.sent.end(), body.orientation.coeffs().data(), body.orientation.coeffs().data() + 4);
      exchange.sent.push_back(body.contacts);
    }
    constexpr int label = 7301;
    requests.resize(requests.size() + 2);
    MPI_Irecv(exchange.received.data(), static_cast<int>(exchange.received.size()), MPI_DOUBLE, exchange.rank, label,
              lammps_->world, &requests[requests.size() - 2]);
    MPI_Isend(exchange.sent.data(), static_cast<int>(exchange.sent.size()), MPI_DOUBLE, exchange.rank, label,
              lammps_->world, &requests[requests.size() - 1]);
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (const Exchange& exchange : exchanges_) {
    const double* at = exchange.received.data();
    for (const int b : exchange.receive) {
      Body& body = bodies_[b];
      for (auto* vector : {&body.motion.position, &body.motion.velocity, &body.motion.angular_velocity}) {
        *vector = Eigen::Map<const Vec3>(at);
        at += 3;
      }
      body.orientation.coeffs() = Eigen::Map<const Eigen::Vector4d>(at);
      at += 4;
      body.contacts = *at++;
    }
  }
}

PosedShape FloeContacts::posed(Body& body, const Vec3& origin) const {
  turn(body);
  const Material& of = materials_[body.shape];
  return {&of.shape, body.axes, body.motion.position - origin, of.hardness};
}

void FloeContacts::add(const Body& body, const Vec3& force, const Vec3& torque) {
  if (body.local < 0) return;
  LastForce& last = last_[&body - bodies_.data()];
  last.force += force;
  last.torque += torque;
  Eigen::Map<Vec3>(forces_[body.local]) += force;
  Eigen::Map<Vec3>(torques_[body.local]) += torque;
}

void FloeContacts::compute_pair(Pair& pair, bool advance) {
  Body& first = bodies_[pair.first];
  Body& second = bodies_[pair.second];
  // The velocities are those of the step that led here; a tenth more for the turning's second order.
  pair.clear -= 1.1 * (first.fastest + second.fastest) * lammps_->update->dt;
  if (advance && pair.clear > 0) return;
  const double reach = materials_[first.shape].shape.reach + materials_[second.shape].shape.reach;
  // Everything relative to the first body's centre.
  const Vec3 apart = nearest_image(second.motion.position - first.motion.position);
  patch_.clear();
  if (apart.squaredNorm() < reach * reach) {
    PosedShape a = posed(first, first.motion.position), b = posed(second, second.motion.position);
    b.position = apart;
    const double gap = separation(a, b);
    if (gap < 0) press(a, b, -gap, patch_);
    pair.clear = gap;
  } else {
    pair.clear = apart.norm() - reach;
  }
  const double way = (first.fastest + second.fastest) * lammps_->update->dt;
  const Material &material_a = materials_[first.shape], &material_b = materials_[second.shape];
  if (patch_.empty()) {
    pair.memory.touching = 0;
    check_way(pair.clear, way, std::min(material_a.shape.thickness, material_b.shape.thickness), first.tag, second.tag);
    return;
  }
  if (pair.memory.touching == 0) {
    check_first_touch(patch_, material_a.hardness * material_b.hardness / (material_a.hardness + material_b.hardness),
                      way, std::min(material_a.shape.reach, material_b.shape.reach), first.tag, second.tag);
  }
  check(patch_, first.motion.inverse_mass + second.motion.inverse_mass,
        std::min(strength(first.shape), strength(second.shape)), first.tag, second.tag);
  if (advance) warn_of_light_between(patch_, first, second);
  RigidMotion of_first = first.motion, of_second = second.motion;
  of_first.position = Vec3::Zero();
  of_second.position = apart;
  const auto load = contact_force(
      patch_, of_first, of_second, material(materials_[first.shape].atom_type, materials_[second.shape].atom_type),
      {lammps_->update->dt, gravity_, std::max(first.contacts, second.contacts)}, advance, pair.memory);
  add(first, load.force, load.torque);
  add(second, -load.force, -(load.torque - apart.cross(load.force)));
}

void FloeContacts::compute_wall(WallPair& pair, bool advance) {
  Body& body = bodies_[pair.body];
  const Wall& wall = walls_[pair.wall];
  const int type = materials_[body.shape].atom_type;
  PosedShape shape = posed(body, body.motion.position);
  const double share = wall_share(type, wall.atom_type);
  shape.hardness *= share;
  std::array<Patch, 6> patches;
  std::array<RigidMotion, 6> motions;
  if (wall.mesh) {
    press_mesh(pair, shape, patches, motions);
  } else {
    const double height = body.motion.position[wall.axis] - wall.place;
    const Vec3 normal = height < 0 ? Vec3(-Vec3::Unit(wall.axis)) : Vec3(Vec3::Unit(wall.axis));
    if (std::abs(height) < materials_[body.shape].shape.reach) {
      press_plane(shape, -std::abs(height) * normal, normal, patches[0]);
    }
    motions[0].velocity = wall.velocity;
  }
  RigidMotion motion = body.motion;
  motion.position = Vec3::Zero();
  for (int direction = 0; direction < 6; ++direction) {
    ContactMemory& memory = pair.memory[direction];
    const double way = (body.fastest + wall.velocity.norm()) * lammps_->update->dt;
    const ConvexShape& of = materials_[body.shape].shape;
    if (patches[direction].empty()) {
      memory.touching = 0;
      if (!wall.mesh && direction == 0) {
        check_way(std::abs(body.motion.position[wall.axis] - wall.place) - of.reach, way, of.thickness, body.tag,
                  -1 - pair.wall);
      }
      continue;
    }
    if (!wall.mesh && memory.touching == 0) {
      check_first_touch(patches[direction], shape.hardness, way, of.reach, body.tag, -1 - pair.wall);
    }
    check(patches[direction], body.motion.inverse_mass, strength(body.shape) * share, body.tag, -1 - pair.wall);
    const auto load = contact_force(patches[direction], motion, motions[direction], material(type, wall.atom_type),
                                    {lammps_->update->dt, gravity_, body.contacts}, advance, memory);
    add(body, load.force, load.torque);
    if (!advance) continue;
    const double step = lammps_->update->dt;
    const Vec3 torque = load.torque + body.motion.position.cross(load.force);
    wall_impulses_[pair.wall] += {-step * load.force, -step * torque};
  }
}

std::vector<std::string> FloeContacts::wall_names() const {
  std::vector<std::string> names;
  for (const Wall& wall : walls_) names.emplace_back(wall.mesh ? wall.mesh->id : wall.fix->id);
  return names;
}

std::vector<coupling::Load> FloeContacts::take_wall_loads() {
  std::vector<coupling::Load> result(wall_impulses_.size());
  for (std::size_t w = 0; w < result.size(); ++w) {
    std::array<double, 6> mine{}, all{};
    Eigen::Map<Vec3>(mine.data()) = wall_impulses_[w].force;
    Eigen::Map<Vec3>(mine.data() + 3) = wall_impulses_[w].torque;
    MPI_Allreduce(mine.data(), all.data(), 6, MPI_DOUBLE, MPI_SUM, lammps_->world);
    if (wall_time_ > 0)
      result[w] = {Eigen::Map<Vec3>(all.data()) / wall_time_, Eigen::Map<Vec3>(all.data() + 3) / wall_time_};
    wall_impulses_[w] = {};
  }
  wall_time_ = 0;
  return result;
}

void FloeContacts::press_mesh(WallPair& pair, const PosedShape& shape, std::array<Patch, 6>& patches,
                              std::array<RigidMotion, 6>& motions) const {
  const Body& body = bodies_[pair.body];
  TriMesh* mesh = walls_[pair.wall].mesh->triMesh();
  auto* velocity = mesh->prop().getElementProperty<MultiVectorContainer<double, 3, 3>>("v");
  std::array<double, 6> weights{};
  for (const int t : pair.triangles) {
    const coupling::Triangle triangle = mesh_triangle(mesh, t, body.motion.position);
    Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
    if (normal.dot(triangle[0]) > 0) normal = -normal;  // the free side is where the body's centre is
    if (-normal.dot(triangle[0]) > shape.shape->reach) continue;
    const int direction = main_direction(normal);
    Patch& patch = patches[direction];
    const std::size_t before = patch.places.size();
    press_triangle(shape, triangle, normal, patch);
    if (!velocity) continue;
    double weight = 0;
    for (std::size_t p = before; p < patch.places.size(); ++p) weight += patch.places[p].size;
    double** nodes = (*velocity)(t);
    const Vec3 mean = (Eigen::Map<Vec3>(nodes[0]) + Eigen::Map<Vec3>(nodes[1]) + Eigen::Map<Vec3>(nodes[2])) / 3;
    motions[direction].velocity += weight * mean;
    weights[direction] += weight;
  }
  for (int direction = 0; direction < 6; ++direction) {
    if (weights[direction] > 0) motions[direction].velocity /= weights[direction];
  }
}

FloeContacts::Energy FloeContacts::stored_energy() {
  Energy energy;
  for (const Pair& pair : pairs_) {
    if (pair.memory.touching == 0 || bodies_[pair.first].local < 0) continue;
    Body& first = bodies_[pair.first];
    Body& second = bodies_[pair.second];
    const PosedShape a = posed(first, first.motion.position);
    PosedShape b = posed(second, first.motion.position);
    b.position = nearest_image(b.position);
    energy.pressure += liggghts::stored_energy(a, b);
    energy.friction += in_springs(pair.memory);
  }
  for (const WallPair& pair : wall_pairs_) {
    const Wall& wall = walls_[pair.wall];
    if (wall.mesh)
      throw InputError(fmt::format("{}: the energy in contacts with meshes is not known", floe_model_name));
    if (pair.memory[0].touching == 0) continue;
    Body& body = bodies_[pair.body];
    PosedShape shape = posed(body, body.motion.position);
    shape.hardness *= wall_share(materials_[body.shape].atom_type, wall.atom_type);
    const double height = body.motion.position[wall.axis] - wall.place;
    const Vec3 normal = height < 0 ? Vec3(-Vec3::Unit(wall.axis)) : Vec3(Vec3::Unit(wall.axis));
    energy.pressure += stored_energy_at_plane(shape, -std::abs(height) * normal, normal);
    energy.friction += in_springs(pair.memory[0]);
  }
  return energy;
}

void FloeContacts::update() {
  if (built_ != lammps_->neighbor->ncalls) {
    build_lists();
    built_ = lammps_->neighbor->ncalls;
  }
  refresh();
  check_ways();
}

void FloeContacts::compute_all(bool advance) {
  Multisphere& bodies = multisphere_->data();
  forces_ = bodies.extract_double_vector("fcm");
  torques_ = bodies.extract_double_vector("torque");
  for (Pair& pair : pairs_) compute_pair(pair, advance);
  for (WallPair& pair : wall_pairs_) compute_wall(pair, advance);
}

void FloeContacts::compute() {
  update();
  for (std::size_t b = 0; b < owned_; ++b) {
    last_[b] = {bodies_[b].motion.position, Vec3::Zero(), Vec3::Zero()};
  }
  compute_all(true);
  wall_time_ += lammps_->update->dt;
}

void FloeContacts::set_up() {
  update();
  const std::vector<LastForce> before = last_;
  for (std::size_t b = 0; b < owned_; ++b) {
    last_[b] = {bodies_[b].motion.position, Vec3::Zero(), Vec3::Zero()};
  }
  compute_all(false);
  for (std::size_t b = 0; b < owned_; ++b) {
    if (before[b].place != bodies_[b].motion.position) continue;
    add(bodies_[b], before[b].force - last_[b].force, before[b].torque - last_[b].torque);
    last_[b] = before[b];
  }
}

FloeContactOutlook FloeContacts::outlook(double window, double acceleration) {
  update();
  FloeContactOutlook result;
  const auto consider = [&](double gap, double speed, double stiffness, double inverse_mass) {
    if (gap > speed * window + acceleration * window * window) return;
    result.may_touch = true;
    result.contact_time = std::min(result.contact_time, std::numbers::pi / std::sqrt(stiffness * inverse_mass));
  };
  for (const Pair& pair : pairs_) {
    Body& first = bodies_[pair.first];
    Body& second = bodies_[pair.second];
    const Material &a = materials_[first.shape], &b = materials_[second.shape];
    PosedShape shape_a = posed(first, first.motion.position), shape_b = posed(second, first.motion.position);
    shape_b.position = nearest_image(shape_b.position);
    const double reach = a.shape.reach + b.shape.reach;
    const double gap = std::max(shape_b.position.norm() - reach, separation(shape_a, shape_b));
    // Rotation and translation are bounded apart: the relative velocity of the centres and each body's own turning.
    const double speed =
        std::min(first.fastest + second.fastest, (second.motion.velocity - first.motion.velocity).norm() +
                                                     first.motion.angular_velocity.norm() * a.shape.reach +
                                                     second.motion.angular_velocity.norm() * b.shape.reach);
    consider(gap, speed, a.hardness * b.hardness / (a.hardness + b.hardness) * std::min(a.face, b.face),
             1 / a.mass + 1 / b.mass);
  }
  for (const WallPair& pair : wall_pairs_) {
    Body& body = bodies_[pair.body];
    const Wall& wall = walls_[pair.wall];
    const Material& of = materials_[body.shape];
    const double stiffness = of.hardness * wall_share(of.atom_type, wall.atom_type) * of.face;
    const PosedShape shape = posed(body, body.motion.position);
    if (!wall.mesh) {
      const double height = body.motion.position[wall.axis] - wall.place;
      const Vec3 normal = height < 0 ? Vec3(-Vec3::Unit(wall.axis)) : Vec3(Vec3::Unit(wall.axis));
      consider(separation_from_plane(shape, -std::abs(height) * normal, normal), body.fastest + wall.velocity.norm(),
               stiffness, 1 / of.mass);
      continue;
    }
    TriMesh* mesh = wall.mesh->triMesh();
    auto* velocity = mesh->prop().getElementProperty<MultiVectorContainer<double, 3, 3>>("v");
    for (const int t : pair.triangles) {
      const coupling::Triangle triangle = mesh_triangle(mesh, t, body.motion.position);
      double speed = 0;
      for (int k = 0; velocity && k < 3; ++k) {
        speed = std::max(speed, Eigen::Map<Vec3>((*velocity)(t)[k]).norm());
      }
      consider(separation_from_triangle(shape, triangle), body.fastest + speed, stiffness, 1 / of.mass);
    }
  }
  return result;
}

double FloeContacts::shortest_contact_time() const {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Material& of : materials_) {
    shortest = std::min(shortest, std::numbers::pi * std::sqrt(of.mass / (of.hardness * of.face)));
  }
  return shortest;
}

}  // namespace embacle::liggghts
