// Checks of a set of bodies before they are created: no overlaps, all inside the simulation box.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "embacle/coupling/shape.hpp"
#include "floe_list.hpp"

namespace embacle::liggghts {

/// A body as the checks see it.
struct PlacedFloe {
  const FloeShape* shape = nullptr;
  coupling::State state;
  std::string origin;
};

/// Depth [m] by which two bodies overlap, negative or zero if they do not. Boxes and convex prisms: by the separating
/// axes of the exact shapes (Gottschalk et al. 1996, doi:10.1145/237170.237244); others by their covering spheres,
/// unless their hulls are apart.
double overlap_depth(const PlacedFloe& a, const PlacedFloe& b);

/// Throws InputError naming the two bodies with the deepest overlap, and how many pairs overlap, if any do by more than
/// 1e-9 of their size. Only pairs with at least one body from `first_new` on are checked.
void check_overlaps(const std::string& where, const std::vector<PlacedFloe>& floes, std::size_t first_new);

/// Throws InputError naming the body that reaches farthest out of the box; `periodic` directions are not checked.
void check_inside(const std::string& where, const std::vector<PlacedFloe>& floes, const coupling::Box& box,
                  const std::array<bool, 3>& periodic);

}  // namespace embacle::liggghts
