#include "fix_floe_create.hpp"

#include <fmt/format.h>

#include <array>

#include "bodies.hpp"
#include "floe_checks.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::InputError;

FixFloeCreate::FixFloeCreate(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  where_ = fmt::format("fix {} {}", id, style);
  list_ = read_floe_list(where_, std::vector<std::string>(argv + 3, argv + argc), atom->ntypes);
  if (!atom->radius_flag || !atom->rmass_flag || !atom->density_flag) {
    throw InputError(where_ + ": needs 'atom_style granular'");
  }
  if (!list_.verbose || comm->me != 0) return;
  for (const FloeShape& shape : list_.shapes) {
    const std::string report = covering_report(shape);
    for (FILE* file : {screen, logfile}) {
      if (file) fmt::print(file, "{}", report);
    }
  }
}

void FixFloeCreate::post_create() {
  FixMultisphere* multisphere = find_multisphere(lmp, where_);
  std::vector<PlacedFloe> placed;
  const auto shapes = floe_shapes(lmp);
  const int shape_offset = static_cast<int>(shapes.size() - list_.shapes.size());  // this fix is the last one
  for (const auto& body : gather_bodies(lmp, multisphere)) {
    if (body.shape < 0 || body.shape >= shape_offset) continue;
    placed.push_back({shapes[body.shape], body.state, fmt::format("the existing body with tag {}", body.tag)});
  }
  const std::size_t first_new = placed.size();
  for (const Floe& floe : list_.floes) placed.push_back({&list_.shapes[floe.shape], floe.state, floe.origin});
  coupling::Box box;
  std::array<bool, 3> periodic{};
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = domain->boxlo[k];
    box.upper[k] = domain->boxhi[k];
    periodic[k] = domain->periodicity[k] != 0;
  }
  check_inside(where_, placed, box, periodic);
  check_overlaps(where_, placed, first_new);

  const std::array<const char*, 9> property = {
      "floeSphere", "all", "property/atom", "floeSphere", "scalar", "yes", "yes", "no", "0."};
  sphere_index_ = static_cast<FixPropertyAtom*>(modify->find_fix_id("floeSphere"));
  if (!sphere_index_) {
    sphere_index_ = modify->add_fix_property_atom(9, const_cast<char**>(property.data()), style);
  }
  create_bodies(lmp, multisphere, list_, shape_offset, groupbit, sphere_index_);
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
