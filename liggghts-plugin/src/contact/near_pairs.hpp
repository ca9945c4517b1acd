// Which of many spheres are near each other.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::liggghts {

/// Pairs (i, j), i < j, i < `first`, of spheres whose gap is below `margin` [m], in ascending order; `period`: of a
/// periodic box [m], zero in directions that are not periodic. By cells of the largest diameter plus margin.
std::vector<std::pair<int, int>> near_pairs(const std::vector<coupling::Vec3>& centres,
                                            const std::vector<double>& radii, std::size_t first, double margin,
                                            const coupling::Vec3& period);

}  // namespace embacle::liggghts
