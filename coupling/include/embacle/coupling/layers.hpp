// Boundary points of any form that has a signed distance: layers parallel to its surface.
#pragma once

#include <functional>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

/// Signed distance [m] of a place, negative inside; sets the unit normal away from inside at the nearest surface.
using DistanceWithNormal = std::function<double(const Vec3& place, Vec3& normal)>;

struct LayerPoint {
  Vec3 position;  ///< [m]
  int layer = 0;  ///< 0: the outermost
};

/// The centres within `bounds` of a lattice of `cell`s [m] that lie inside and within `depth` [m], each moved along the
/// normal onto the nearest layer: the lattice itself where faces fit it, and everywhere as many points as the layer has
/// room for. Layer k lies (k + 1/2) `spacing` below the surface. In two dimensions z = 0. With `thin` a centre stays
/// where it is if the body is too thin for its layer, which then lies beyond the middle.
std::vector<LayerPoint> layer_points(const Box& bounds, const Vec3& cell, int dimension, double spacing, double depth,
                                     const DistanceWithNormal& distance, bool thin = false);

/// Makes the points of a form even: those nearer to each other than the spacing move apart within their layers; of two
/// that still are within half a spacing the inner one is dropped, and so is what lies less than a fifth of a spacing
/// below the surface, in sharp corners. An even lattice stays as it is.
void even_out(std::vector<LayerPoint>& points, int dimension, double spacing, const DistanceWithNormal& distance);

}  // namespace embacle::coupling
