// The coupled phase of a run.
#pragma once

#include "embacle/liggghts/driver.hpp"
#include "fix_couple_mps.hpp"

namespace embacle::liggghts {

/// Runs windows until the fluid finishes. `folder`: for floes.csv; empty: no file. Collective over the solid ranks;
/// fills the report's figures of the windows.
void run_coupled(LAMMPS_NS::LAMMPS* lammps, FixCoupleMps* fix, const coupling::Participants& participants, MPI_Comm own,
                 const std::string& folder, const coupling::YieldHook& yield, SolidReport& report);

}  // namespace embacle::liggghts
