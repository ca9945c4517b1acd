// How LIGGGHTS scripts reach the contacts of model floe.
#pragma once

#include "stock.hpp"

namespace embacle::liggghts {

class FloeContacts;

/// Makes `model floe` known to pair_style gran and fix wall/gran, and `fix floe/contacts`, which keeps what contacts
/// remember. May be called more than once.
void register_floe_styles(LAMMPS_NS::LAMMPS* lammps);

/// The contacts of the script's `pair_style gran model floe`; null if the pair style is another one, or not yet set up.
FloeContacts* floe_contacts(LAMMPS_NS::LAMMPS* lammps);

}  // namespace embacle::liggghts
