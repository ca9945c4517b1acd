#include "fix_couple_mps.hpp"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <map>
#include <unordered_map>

#include "bodies.hpp"
#include "fix_floe_create.hpp"
#include "stock_access.hpp"
#include "words.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::InputError;
using coupling::Vec3;
namespace {

/// A vector stored as three numbers.
Eigen::Map<Vec3> at(double* numbers) { return Eigen::Map<Vec3>(numbers); }

/// Numbers that a checkpoint keeps of a body: its tag and eight vectors.
constexpr std::size_t kept_width = 1 + 3 * 8;

}  // namespace

FixCoupleMps::FixCoupleMps(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  where_ = fmt::format("fix {} {}", id, style);
  Words words(where_, std::vector<std::string>(argv + 3, argv + argc));
  while (!words.empty()) {
    const std::string name = words.word("a keyword");
    if (name == "pressures") {
      const std::string every = words.word("'every' after 'pressures'");
      if (every != "every") words.fail_unknown("word after 'pressures'", every, {"every"});
      pressures_every_ = words.integer("the number of windows after 'pressures every'", 1);
    } else if (name == "resolution") {
      rule_.resolution = words.positive_number("resolution (sub-steps per contact time)");
      if (rule_.resolution < 20) words.fail("resolution must be at least 20: coarser contacts gain energy");
    } else if (name == "minimum_speed") {
      rule_.minimum_speed = words.positive_number("minimum_speed [m/s]");
    } else {
      words.fail_unknown("keyword", name, {"pressures", "resolution", "minimum_speed"});
    }
  }
  force_reneighbor = 1;
  next_reneighbor = -1;
  restart_global = 1;
}

int FixCoupleMps::setmask() { return FixConst::PRE_FORCE; }

FixCoupleMps::BodyVector* FixCoupleMps::add_body_vector(const char* name) {
  auto& properties = multisphere_->data().prop();
  if (auto* existing = properties.getElementProperty<BodyVector>(name)) return existing;
  return properties.addElementProperty<BodyVector>(name, "comm_exchange_borders", "frame_invariant", "restart_no", 1,
                                                   multisphere_->data().n_body());
}

void FixCoupleMps::post_create() {
  multisphere_ = find_multisphere(lmp, where_);
  force_ = add_body_vector("water_force");
  torque_ = add_body_vector("water_torque");
  force_before_ = add_body_vector("water_force_before");
  torque_before_ = add_body_vector("water_torque_before");
  velocity_start_ = add_body_vector("velocity_at_window_start");
  angular_momentum_start_ = add_body_vector("angular_momentum_at_window_start");
  contact_force_ = add_body_vector("contact_force");
  contact_torque_ = add_body_vector("contact_torque");
  for (BodyVector* property : {force_, torque_, force_before_, torque_before_, velocity_start_, angular_momentum_start_,
                               contact_force_, contact_torque_}) {
    property->setAll(0.0);
    property->setDefaultValue(0.0);
  }
  if (pressures_every_ > 0) {
    const std::array<const char*, 9> property = {
        "waterPressure", "all", "property/atom", "waterPressure", "scalar", "yes", "yes", "yes", "0."};
    pressure_ = modify->add_fix_property_atom(9, const_cast<char**>(property.data()), style);
  }
}

void FixCoupleMps::init() {
  if (std::strcmp(update->unit_style, "si") != 0) {
    throw InputError(fmt::format("{}: needs 'units si', not 'units {}'", where_, update->unit_style));
  }
  if (neighbor->delay != 0 || neighbor->every != 1 || neighbor->dist_check != 1) {
    throw InputError(where_ + ": needs 'neigh_modify delay 0 every 1 check yes', because its time steps can be long");
  }
  if (floe_shapes(lmp).empty()) {
    throw InputError(where_ + ": needs bodies from 'fix floe/create', which tells the fluid their shapes");
  }
  sphere_index_ = static_cast<FixPropertyAtom*>(modify->find_fix_id("floeSphere"));
}

void FixCoupleMps::pre_force(int) {
  // LIGGGHTS adds these to the sums of force and torque in every step, but does not migrate them with the body.
  Multisphere& data = multisphere_->data();
  double** forces = data.extract_double_vector("dragforce_cm");
  double** torques = data.extract_double_vector("hdtorque_cm");
  for (int i = 0; i < data.n_body(); ++i) {
    at(forces[i]) = at((*force_)(i));
    at(torques[i]) = at((*torque_)(i));
    at((*force_before_)(i)) = at((*force_)(i));
    at((*torque_before_)(i)) = at((*torque_)(i));
  }
}

Vec3 FixCoupleMps::gravity() const { return gravity_of(lmp); }

coupling::SolidTerms FixCoupleMps::terms() const {
  coupling::SolidTerms terms;
  terms.gravity = gravity();
  terms.units = update->unit_style;
  for (int k = 0; k < 3; ++k) {
    terms.domain.lower[k] = domain->boxlo[k];
    terms.domain.upper[k] = domain->boxhi[k];
  }
  terms.surface_pressure_every = pressures_every_;
  std::map<std::string, int> uses;  // shapes that differ in what their names do not say
  for (const FloeShape* shape : floe_shapes(lmp)) {
    terms.shapes.push_back(shape->shape);
    const int use = ++uses[shape->shape.name];
    if (use > 1) terms.shapes.back().name += fmt::format(" ({})", use);
  }
  return terms;
}

void FixCoupleMps::require_unit_depth() const {
  // Two-dimensional water gives loads per metre of depth: they belong to a body that is one metre deep.
  for (const FloeShape* floe : floe_shapes(lmp)) {
    const auto& shape = floe->shape;
    const bool straight = shape.kind == coupling::ShapeKind::box || shape.kind == coupling::ShapeKind::prism;
    const double depth = straight ? shape.size.z() : shape.kind == coupling::ShapeKind::cylinder ? shape.size.y() : 0;
    if (depth != 1) {
      throw InputError(
          fmt::format("{}: in two-dimensional water bodies are boxes, prisms or cylinders that are 1 m long along "
                      "z, but there is a {}",
                      where_, shape.name));
    }
  }
}

void FixCoupleMps::prepare(const coupling::FluidTerms& fluid) {
  if (fluid.dimension == 2) require_unit_depth();
  if (pressures_every_ == 0) return;
  for (const FloeShape* floe : floe_shapes(lmp)) {
    const auto points = floe->shape.points(fluid.particle_distance, fluid.point_depth, fluid.dimension);
    std::vector<PointShare> shares;
    std::vector<double> areas(floe->spheres.size(), 0.0);
    for (const auto& point : points) {
      int nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s < floe->spheres.size(); ++s) {
        const double distance = (floe->spheres[s].centre - point.position).squaredNorm();
        if (distance < least) {
          least = distance;
          nearest = static_cast<int>(s);
        }
      }
      shares.push_back({nearest, point.area});
      areas[nearest] += point.area;
    }
    point_share_.push_back(std::move(shares));
    sphere_area_.push_back(std::move(areas));
  }
}

std::vector<coupling::SolidBody> FixCoupleMps::bodies() const {
  auto result = owned_bodies(lmp, multisphere_);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i].shape < 0) {
      throw InputError(fmt::format("{}: body {} was not made by fix floe/create, so the fluid cannot know its shape",
                                   where_, result[i].tag));
    }
    result[i].state.contact_force = at((*contact_force_)(static_cast<int>(i)));
    result[i].state.contact_torque = at((*contact_torque_)(static_cast<int>(i)));
  }
  return result;
}

void FixCoupleMps::take_loads(const coupling::SolidLink& link) {
  Multisphere& data = multisphere_->data();
  for (int i = 0; i < data.n_body(); ++i) {
    const coupling::Load load = link.load(data.tag(i));
    at((*force_)(i)) = load.force;
    at((*torque_)(i)) = load.torque;
  }
  // Whether pressures came is the same on all ranks: every so many windows.
  if (pressure_) take_pressures(link.surface_pressures());
}

void FixCoupleMps::take_pressures(const std::vector<coupling::BodyPressures>& all) {
  int due = all.empty() ? 0 : 1;
  MPI_Allreduce(MPI_IN_PLACE, &due, 1, MPI_INT, MPI_MAX, world);
  if (!due) return;
  Multisphere& data = multisphere_->data();
  std::unordered_map<int, std::vector<double>> on_spheres;  // by tag
  const auto owned = owned_bodies(lmp, multisphere_);
  for (const auto& body : owned) {
    on_spheres[static_cast<int>(body.tag)].assign(sphere_area_[body.shape].size(), 0.0);
  }
  for (const auto& part : all) {
    const auto place = on_spheres.find(static_cast<int>(part.tag));
    if (place == on_spheres.end()) continue;
    const int shape = owned[data.map(static_cast<int>(part.tag))].shape;
    for (std::size_t k = 0; k < part.point.size(); ++k) {
      const PointShare& share = point_share_[shape][part.point[k]];
      if (share.area > 0)
        place->second[share.sphere] += part.pressure[k] * share.area / sphere_area_[shape][share.sphere];
    }
  }
  sphere_index_->do_forward_comm();  // ghosts of the bodies' spheres on other ranks
  const int all_atoms = atom->nlocal + atom->nghost;
  for (int i = 0; i < all_atoms; ++i) {
    pressure_->vector_atom[i] = 0;
    const int tag = multisphere_->belongs_to(i);
    const auto place = tag > 0 ? on_spheres.find(tag) : on_spheres.end();
    if (place == on_spheres.end() || !domain->is_owned_or_first_ghost(i)) continue;
    pressure_->vector_atom[i] = place->second[static_cast<std::size_t>(sphere_index_->vector_atom[i])];
  }
  pressure_->do_reverse_comm();  // adds the owner's value to the rank that holds the sphere
}

void FixCoupleMps::begin_window() {
  // The sums of force and torque that the first half kick uses were made with the load of the window before.
  Multisphere& data = multisphere_->data();
  double** forces = data.extract_double_vector("fcm");
  double** torques = data.extract_double_vector("torque");
  for (int i = 0; i < data.n_body(); ++i) {
    at(forces[i]) += at((*force_)(i)) - at((*force_before_)(i));
    at(torques[i]) += at((*torque_)(i)) - at((*torque_before_)(i));
    at((*force_before_)(i)) = at((*force_)(i));
    at((*torque_before_)(i)) = at((*torque_)(i));
    data.vcm((*velocity_start_)(i), i);
    data.angmom((*angular_momentum_start_)(i), i);
  }
}

void FixCoupleMps::end_window(double window) {
  Multisphere& data = multisphere_->data();
  const Vec3 fall = gravity();
  for (int i = 0; i < data.n_body(); ++i) {
    Vec3 velocity, angular_momentum;
    data.vcm(velocity.data(), i);
    data.angmom(angular_momentum.data(), i);
    at((*contact_force_)(i)) =
        data.mass(i) * ((velocity - at((*velocity_start_)(i))) / window - fall) - at((*force_)(i));
    at((*contact_torque_)(i)) = (angular_momentum - at((*angular_momentum_start_)(i))) / window - at((*torque_)(i));
  }
}

void FixCoupleMps::write_restart(FILE* file) {
  Multisphere& data = multisphere_->data();
  double** forces = data.extract_double_vector("fcm");
  double** torques = data.extract_double_vector("torque");
  std::vector<double> mine;
  for (int i = 0; i < data.n_body(); ++i) {
    mine.push_back(static_cast<double>(data.tag(i)));
    for (BodyVector* property : remembered()) mine.insert(mine.end(), (*property)(i), (*property)(i) + 3);
    mine.insert(mine.end(), forces[i], forces[i] + 3);
    mine.insert(mine.end(), torques[i], torques[i] + 3);
  }
  kept_ = {update->get_cur_time(), update->dt, update->ntimestep, atom->natoms, gather_on_all(world, mine)};
  if (comm->me != 0) return;
  std::vector<double> record = {kept_.time,
                                kept_.step_length,
                                static_cast<double>(kept_.step),
                                static_cast<double>(kept_.atoms),
                                static_cast<double>(progress.size()),
                                static_cast<double>(kept_.bodies.size())};
  record.insert(record.end(), progress.begin(), progress.end());
  record.insert(record.end(), kept_.bodies.begin(), kept_.bodies.end());
  const int bytes = static_cast<int>(record.size() * sizeof(double));
  fwrite(&bytes, sizeof bytes, 1, file);
  fwrite(record.data(), sizeof(double), record.size(), file);
}

void FixCoupleMps::restart(char* buffer) {
  std::array<double, 6> head{};
  std::memcpy(head.data(), buffer, sizeof head);
  kept_ = {head[0], head[1], static_cast<bigint>(head[2]), static_cast<bigint>(head[3]), {}};
  progress.resize(static_cast<std::size_t>(head[4]));
  kept_.bodies.resize(static_cast<std::size_t>(head[5]));
  buffer += sizeof head;
  for (auto* part : {&progress, &kept_.bodies}) {
    std::memcpy(part->data(), buffer, part->size() * sizeof(double));
    buffer += part->size() * sizeof(double);
  }
  continues_ = true;
}

void FixCoupleMps::check_taken_up() const {
  if (update->ntimestep != kept_.step) {
    throw InputError(fmt::format(
        "{}: the script runs to step {} before the coupled run, which continues from step {} of the checkpoint; let it "
        "run only where nothing continues: if \"${{restarted}} == 0\" then \"run N\"",
        where_, update->ntimestep, kept_.step));
  }
  if (atom->natoms != kept_.atoms) {
    throw InputError(fmt::format(
        "{}: the script makes {} particles beside the {} of the checkpoint from which the run continues; let it make "
        "them only where nothing continues: if \"${{restarted}} == 0\" then \"fix ...\"",
        where_, atom->natoms - kept_.atoms, kept_.atoms));
  }
}

void FixCoupleMps::take_up_state() {
  set_time_step(lmp, kept_.step_length);
  update->atime = kept_.time;
  update->atimestep = update->ntimestep;
  for (const auto& [i, record] : kept_of_own()) {
    const double* values = record;
    for (BodyVector* property : remembered()) {
      at((*property)(i)) = Eigen::Map<const Vec3>(values);
      values += 3;
    }
  }
}

void FixCoupleMps::take_up_forces() {
  Multisphere& data = multisphere_->data();
  double** forces = data.extract_double_vector("fcm");
  double** torques = data.extract_double_vector("torque");
  for (const auto& [i, record] : kept_of_own()) {
    const auto part = [&, values = record](int k) { return Eigen::Map<const Vec3>(values + 3 * k); };
    at((*force_before_)(i)) = part(2);
    at((*torque_before_)(i)) = part(3);
    at(forces[i]) = part(6);
    at(torques[i]) = part(7);
  }
}

std::vector<std::pair<int, const double*>> FixCoupleMps::kept_of_own() const {
  Multisphere& data = multisphere_->data();
  std::vector<std::pair<int, const double*>> found;
  for (std::size_t row = 0; row + kept_width <= kept_.bodies.size(); row += kept_width) {
    const int i = data.map(static_cast<int>(kept_.bodies[row]));
    if (i >= 0) found.emplace_back(i, kept_.bodies.data() + row + 1);
  }
  return found;
}

std::vector<std::pair<coupling::BodyTag, coupling::Load>> FixCoupleMps::kept_loads() const {
  std::vector<std::pair<coupling::BodyTag, coupling::Load>> result;
  for (std::size_t row = 0; row + kept_width <= kept_.bodies.size(); row += kept_width) {
    const double* values = kept_.bodies.data() + row;
    result.push_back({static_cast<coupling::BodyTag>(values[0]), {Vec3(values + 1), Vec3(values + 4)}});
  }
  return result;
}

FixCoupleMps* find_couple_mps(LAMMPS* lammps) {
  FixCoupleMps* found = nullptr;
  for (int i = 0; i < lammps->modify->nfix; ++i) {
    auto* candidate = dynamic_cast<FixCoupleMps*>(lammps->modify->fix[i]);
    if (candidate && found) throw InputError("the script has more than one fix couple/mps");
    if (candidate) found = candidate;
  }
  return found;
}

}  // namespace embacle::liggghts
