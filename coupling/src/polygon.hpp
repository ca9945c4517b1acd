// Simple polygons: checks, triangles, distance.
#pragma once

#include <array>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

using Vec2 = Eigen::Vector2d;

/// The polygon counterclockwise, without corners at which it does not turn. Throws InputError, naming corners by their
/// numbers from 1, unless it is simple.
std::vector<Vec2> checked_polygon(const std::vector<Vec2>& corners);

/// Triangles, by indices of corners, that fill a simple counterclockwise polygon: ears are cut off one by one (Meisters
/// 1975, doi:10.2307/2319703).
std::vector<std::array<int, 3>> triangulate(const std::vector<Vec2>& polygon);

/// Signed distance [m] to a counterclockwise polygon, negative inside; and, unless null, the unit normal away from
/// inside.
double polygon_distance(const std::vector<Vec2>& polygon, const Vec2& place, Vec2* normal = nullptr);

}  // namespace embacle::coupling
