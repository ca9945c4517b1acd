#pragma once

#include "embacle/coupling/shape.hpp"

namespace embacle::coupling {

/// Largest and mean distance [m] from the shape's surface, in parts of at most `spacing`, to the nearest sphere.
struct SurfaceGaps {
  double largest = 0, mean = 0;
};
SurfaceGaps surface_gaps(const Shape& shape, const std::vector<CoveringSphere>& spheres, double spacing);

}  // namespace embacle::coupling
