#pragma once

#include "embacle/coupling/shape.hpp"

namespace embacle::coupling {

/// The faces of a box, sphere or cylinder, divided among its points: one piece of each face that shares a point.
std::vector<SurfacePiece> pieces_of_points(const Shape& shape, const std::vector<ShapePoint>& points);

}  // namespace embacle::coupling
