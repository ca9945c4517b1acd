// Doors to members of LIGGGHTS classes that have no public accessor.
#pragma once

#include <span>
#include <string>

#include "embacle/coupling/types.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

using FixCreator = LAMMPS_NS::Fix* (*)(LAMMPS_NS::LAMMPS*, int, char**);

/// Makes `creator` build fixes of the given style name in `lammps`.
void register_fix_style(LAMMPS_NS::LAMMPS* lammps, const std::string& style, FixCreator creator);

using CommandCreator = void (*)(LAMMPS_NS::LAMMPS*, int, char**);

/// Makes `creator` run when the script gives the command.
void replace_command(LAMMPS_NS::LAMMPS* lammps, const std::string& command, CommandCreator creator);

/// Changes the time step [s] everywhere LIGGGHTS keeps a copy of it, as fix dt/reset does; fix multisphere included,
/// which fix dt/reset forgets.
void set_time_step(LAMMPS_NS::LAMMPS* lammps, double step);

/// Positions [m] of the local atoms at the last build of the neighbour lists (nlocal rows), or null before the first.
double** positions_at_neighbour_build(LAMMPS_NS::LAMMPS* lammps);

/// A primitive wall that is a plane.
struct PrimitivePlane {
  int axis = -1;  ///< 0, 1, 2; -1: the wall is no plane
  double place = 0;
  coupling::Vec3 velocity = coupling::Vec3::Zero();  ///< of fix wall/gran's keyword shear [m/s]
};
PrimitivePlane primitive_plane(LAMMPS_NS::FixWallGran* wall);

using VariantSelector = std::int64_t (*)(int&, char**&, LAMMPS_NS::Custom_contact_models);

/// Makes `selector` choose among the contact models of pair_style gran and fix wall/gran.
void replace_variant_selectors(VariantSelector selector);

/// The line of the input script that LIGGGHTS reads at present, variables not yet replaced; may be empty.
std::string current_script_line(LAMMPS_NS::LAMMPS* lammps);

}  // namespace embacle::liggghts
