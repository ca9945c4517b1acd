#include "styles.hpp"

#include "contact/floe_styles.hpp"
#include "fix_couple_mps.hpp"
#include "fix_floe_create.hpp"
#include "fix_floe_outlet.hpp"
#include "fix_floe_record.hpp"
#include "fix_floe_tether.hpp"
#include "laws/law_styles.hpp"
#include "stock_access.hpp"

namespace embacle::liggghts {

namespace {

template <typename Style>
LAMMPS_NS::Fix* make(LAMMPS_NS::LAMMPS* lammps, int argc, char** argv) {
  return new Style(lammps, argc, argv);
}

}  // namespace

void register_styles(LAMMPS_NS::LAMMPS* lammps) {
  register_fix_style(lammps, "floe/create", &make<FixFloeCreate>);
  register_fix_style(lammps, "floe/outlet", &make<FixFloeOutlet>);
  register_fix_style(lammps, "floe/record", &make<FixFloeRecord>);
  register_fix_style(lammps, "floe/tether", &make<FixFloeTether>);
  register_fix_style(lammps, "couple/mps", &make<FixCoupleMps>);
  register_floe_styles(lammps);
  register_law_styles();
}

}  // namespace embacle::liggghts
