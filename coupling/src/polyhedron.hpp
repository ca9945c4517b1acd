// What Shape needs of bodies of plane faces.
#pragma once

#include "embacle/coupling/shape.hpp"

namespace embacle::coupling {

/// Points as Shape::points gives them, without areas and normals, and the pieces of the faces that belong to them.
std::vector<ShapePoint> polyhedron_points(const Shape& shape, double spacing, double depth, int dimension,
                                          std::vector<SurfacePiece>& pieces);

}  // namespace embacle::coupling
