// Doors to members of LIGGGHTS classes that have no public accessor.
#pragma once

#include <span>
#include <string>

#include "stock.hpp"

namespace embacle::liggghts {

using FixCreator = LAMMPS_NS::Fix* (*)(LAMMPS_NS::LAMMPS*, int, char**);

/// Makes `creator` build fixes of the given style name in `lammps`.
void register_fix_style(LAMMPS_NS::LAMMPS* lammps, const std::string& style, FixCreator creator);

/// Changes the time step [s] everywhere LIGGGHTS keeps a copy of it, as fix dt/reset does; fix multisphere included,
/// which fix dt/reset forgets.
void set_time_step(LAMMPS_NS::LAMMPS* lammps, double step);

/// Positions [m] of the local atoms at the last build of the neighbour lists (nlocal rows), or null before the first.
double** positions_at_neighbour_build(LAMMPS_NS::LAMMPS* lammps);

/// The line of the input script that LIGGGHTS reads at present, variables not yet replaced; may be empty.
std::string current_script_line(LAMMPS_NS::LAMMPS* lammps);

}  // namespace embacle::liggghts
