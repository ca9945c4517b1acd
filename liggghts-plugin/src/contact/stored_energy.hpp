// The energy that a contact's pressure stores: the potential of which Patch is the gradient. No LIGGGHTS here.
#pragma once

#include "contact/patch.hpp"

namespace embacle::liggghts {

/// Integral [J] over the overlap of two bodies of the smaller of both pressures; zero if they do not touch.
double stored_energy(const PosedShape& first, const PosedShape& second);
/// Integral [J] of a body's pressure over its part beyond the plane through `point` with the unit normal towards the
/// free side.
double stored_energy_at_plane(const PosedShape& body, const coupling::Vec3& point, const coupling::Vec3& normal);

}  // namespace embacle::liggghts
