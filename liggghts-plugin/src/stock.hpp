// The stock LIGGGHTS headers this plugin needs, and the proof that they describe the installed library.
#pragma once

#include <mpi.h>
// The order of these headers follows LIGGGHTS' own needs.
#include <lammps.h>

#include <atom.h>
#include <atom_vec.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <finish.h>
#include <fix_gravity.h>
#include <fix_mesh_surface.h>
#include <fix_multisphere.h>
#include <fix_neighlist_mesh.h>
#include <fix_property_atom.h>
#include <fix_property_global.h>
#include <fix_wall_gran.h>
#include <force.h>
#include <group.h>
#include <input.h>
#include <integrate.h>
#include <modify.h>
#include <neigh_list.h>
#include <neighbor.h>
#include <output.h>
#include <pair.h>
#include <primitive_wall.h>
#include <timer.h>
#include <update.h>
#include <variable.h>

namespace embacle::liggghts {

// Sizes of the classes in the Debian package liggghts 3.8.0. Another build option (superquadric, nonspherical) changes
// their layout: the plugin must then be compiled with the same defines as the library.
static_assert(sizeof(LAMMPS_NS::Modify) == 0x250);
static_assert(sizeof(LAMMPS_NS::Comm) == 0x378);
static_assert(sizeof(LAMMPS_NS::Domain) == 0x478);
static_assert(sizeof(LAMMPS_NS::Atom) == 0x5c8);
static_assert(sizeof(LAMMPS_NS::Force) == 0x588);
static_assert(sizeof(LAMMPS_NS::Update) == 0x170);
static_assert(sizeof(LAMMPS_NS::FixMultisphere) == 0x2e0);
static_assert(sizeof(LAMMPS_NS::MultisphereParallel) == 0x1c8);
static_assert(sizeof(LAMMPS_NS::FixWallGran) == 0x3a0);

}  // namespace embacle::liggghts
