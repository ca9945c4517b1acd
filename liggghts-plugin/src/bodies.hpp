// Multisphere bodies made exactly from shapes, and their state read back.
#pragma once

#include <vector>

#include "embacle/coupling/link.hpp"
#include "floe_list.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

/// The one fix multisphere of the script; throws InputError if there is none or more than one.
LAMMPS_NS::FixMultisphere* find_multisphere(LAMMPS_NS::LAMMPS* lammps, const std::string& where);

/// Number of the first multisphere body type that belongs to floe shapes: body type = first_floe_type + shape index.
inline constexpr int first_floe_type = 1000;

/// Creates bodies of `shapes` with exactly the position, orientation, velocity, mass and inertia of the description.
/// Collective. Body tags go on from `last_tag`, or from the largest there is, in the order of the floes, on any number
/// of ranks; returns the last one. The spheres enter the group `group_bit`; their index in the covering is written to
/// `sphere_index`. The floes must have been checked: inside the simulation box.
int create_bodies(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere,
                  const std::vector<FloeShape>& shapes, const std::vector<Floe>& floes, int shape_offset, int group_bit,
                  LAMMPS_NS::FixPropertyAtom* sphere_index, int last_tag = 0);

/// Removes bodies and their spheres. Collective; `tags`: the same on every rank. A set-up of the run must follow.
void remove_bodies(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere,
                   const std::vector<coupling::BodyTag>& tags);

/// A body this rank owns, by its index in fix multisphere, with its present state; contact force and torque are zero.
/// In a periodic direction the position is the unwrapped one. A body that no floe shape describes has shape -1.
coupling::SolidBody owned_body(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere, int local);

/// All bodies this rank owns.
std::vector<coupling::SolidBody> owned_bodies(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere);

/// The states of all bodies on all ranks, by ascending tag. Collective; meant for set-up, not for time steps.
std::vector<coupling::SolidBody> gather_bodies(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere);

/// Of the script's fix gravity, zero without one [m/s^2].
coupling::Vec3 gravity_of(LAMMPS_NS::LAMMPS* lammps);

/// The numbers of all ranks one after another, on every rank. Collective.
std::vector<double> gather_on_all(MPI_Comm world, const std::vector<double>& mine);

}  // namespace embacle::liggghts
