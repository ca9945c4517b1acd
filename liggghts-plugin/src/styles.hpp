// The styles this plugin adds to LIGGGHTS.
#pragma once

namespace LAMMPS_NS {  // NOLINT(readability-identifier-naming): their name
class LAMMPS;
}

namespace embacle::liggghts {

/// Adds the fixes floe/create, floe/record, floe/tether and couple/mps, and the contact laws, to `lammps`. Call before
/// any script line is read.
void register_styles(LAMMPS_NS::LAMMPS* lammps);

}  // namespace embacle::liggghts
