#include "fix_floe_create.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "bodies.hpp"
#include "floe_checks.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::InputError;

FixFloeCreate::FixFloeCreate(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  restart_global = 1;
  where_ = fmt::format("fix {} {}", id, style);
  list_ = read_floe_list(where_, std::vector<std::string>(argv + 3, argv + argc), atom->ntypes);
  list_.cover(world);
  if (!atom->radius_flag || !atom->rmass_flag || !atom->density_flag) {
    throw InputError(where_ + ": needs 'atom_style granular'");
  }
  schedule_ = FloeSchedule(list_);
  if (!list_.verbose || comm->me != 0) return;
  for (const FloeShape& shape : list_.shapes) {
    const std::string report = covering_report(shape);
    for (FILE* file : {screen, logfile}) {
      if (file) fmt::print(file, "{}", report);
    }
  }
}

void FixFloeCreate::post_create() {
  FixMultisphere* const multisphere = multisphere_ = find_multisphere(lmp, where_);
  const std::array<const char*, 9> property = {
      "floeSphere", "all", "property/atom", "floeSphere", "scalar", "yes", "yes", "no", "0."};
  sphere_index_ = static_cast<FixPropertyAtom*>(modify->find_fix_id("floeSphere"));
  if (!sphere_index_) {
    sphere_index_ = modify->add_fix_property_atom(9, const_cast<char**>(property.data()), style);
  }
  if (restored_) return;
  std::vector<PlacedFloe> placed;
  const auto shapes = floe_shapes(lmp);
  const int shape_offset = first_shape();
  for (const auto& body : gather_bodies(lmp, multisphere)) {
    if (body.shape < 0 || body.shape >= shape_offset) continue;
    placed.push_back({shapes[body.shape], body.state, fmt::format("the existing body with tag {}", body.tag)});
  }
  const std::size_t first_new = placed.size();
  std::vector<Floe> at_once;
  std::vector<PlacedFloe> all;
  for (const Floe& floe : list_.floes) {
    all.push_back({&list_.shapes[floe.shape], floe.state, floe.origin});
    if (floe.enters) continue;
    at_once.push_back(floe);
    placed.push_back(all.back());
  }
  coupling::Box box;
  std::array<bool, 3> periodic{};
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = domain->boxlo[k];
    box.upper[k] = domain->boxhi[k];
    periodic[k] = domain->periodicity[k] != 0;
  }
  check_inside(where_, all, box, periodic);
  check_overlaps(where_, placed, first_new);
  if (!at_once.empty()) create_bodies(lmp, multisphere, list_.shapes, at_once, shape_offset, groupbit, sphere_index_);
}

double FixFloeCreate::max_rad(int type) {
  double radius = 0;
  for (const FloeShape& shape : list_.shapes) {
    if (shape.atom_type == type) radius = std::max(radius, shape.spheres.front().radius);
  }
  return radius;
}

double FixFloeCreate::min_rad(int type) {
  double radius = max_rad(type);
  for (const FloeShape& shape : list_.shapes) {
    if (shape.atom_type == type) radius = std::min(radius, shape.spheres.front().radius);
  }
  return radius;
}

// As LIGGGHTS has it for bodies that are there. With the radius about the whole shape, which is a little larger, runs
// that continue from a restart file on several ranks crashed now and then in FixMultisphere::set_xv.
double FixFloeCreate::extend_cut_ghost() {
  double reach = 0;
  for (const FloeShape& shape : list_.shapes) {
    for (const auto& sphere : shape.spheres) reach = std::max(reach, sphere.centre.norm() + sphere.radius);
  }
  return 2 * reach;
}

int FixFloeCreate::add(const std::vector<Floe>& floes, int last_tag) {
  return create_bodies(lmp, multisphere_, list_.shapes, floes, first_shape(), groupbit, sphere_index_, last_tag);
}

int FixFloeCreate::first_shape() const {
  int first = 0;
  for (int i = 0; i < modify->nfix; ++i) {
    const auto* fix = dynamic_cast<const FixFloeCreate*>(modify->fix[i]);
    if (fix == this) break;
    if (fix) first += static_cast<int>(fix->list().shapes.size());
  }
  return first;
}

namespace {

/// What must be the same for bodies of a restart file to belong to these shapes.
std::vector<double> description(const FloeList& list) {
  std::vector<double> numbers;
  for (const FloeShape& shape : list.shapes) {
    const auto properties = shape.shape.mass_properties();
    numbers.insert(numbers.end(), {static_cast<double>(shape.shape.kind), static_cast<double>(shape.atom_type),
                                   static_cast<double>(shape.spheres.size()), shape.spheres[0].radius, properties.mass,
                                   properties.inertia.x(), properties.inertia.y(), properties.inertia.z()});
  }
  return numbers;
}

}  // namespace

void FixFloeCreate::write_restart(FILE* file) {
  if (comm->me != 0) return;
  std::vector<double> numbers = description(list_);
  numbers.insert(numbers.begin(), static_cast<double>(numbers.size()));
  for (const std::vector<double>& part : {schedule_.save(), traffic}) {
    numbers.push_back(static_cast<double>(part.size()));
    numbers.insert(numbers.end(), part.begin(), part.end());
  }
  const int bytes = static_cast<int>(numbers.size() * sizeof(double));
  fwrite(&bytes, sizeof bytes, 1, file);
  fwrite(numbers.data(), sizeof(double), numbers.size(), file);
}

void FixFloeCreate::restart(char* buffer) {
  const auto next_part = [&] {
    double count = 0;
    std::memcpy(&count, buffer, sizeof(double));
    std::vector<double> numbers(static_cast<std::size_t>(count));
    std::memcpy(numbers.data(), buffer + sizeof(double), numbers.size() * sizeof(double));
    buffer += (1 + numbers.size()) * sizeof(double);
    return numbers;
  };
  if (next_part() != description(list_)) {
    throw InputError(where_ +
                     ": the bodies of the restart file have other shapes; give the fix the same shapes, in the "
                     "same order, or another name to create further bodies");
  }
  schedule_.restore(next_part());
  traffic = next_part();
  restored_ = true;
}

void FixFloeCreate::pre_delete(bool unfix) {
  if (unfix) throw InputError(where_ + ": may not be unfixed, it holds the shapes of the bodies");
}

std::vector<const FloeShape*> floe_shapes(LAMMPS* lammps) {
  std::vector<const FloeShape*> shapes;
  for (int i = 0; i < lammps->modify->nfix; ++i) {
    const auto* fix = dynamic_cast<const FixFloeCreate*>(lammps->modify->fix[i]);
    if (!fix) continue;
    for (const FloeShape& shape : fix->list().shapes) shapes.push_back(&shape);
  }
  return shapes;
}

}  // namespace embacle::liggghts
