// Covering spheres of the shapes for contacts: inscribed, so that they touch the faces from inside.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "embacle/coupling/shape.hpp"

namespace embacle::coupling {

namespace {

/// `count` positions from -reach to reach, at most about `spacing` apart; the middle alone if there is no room.
std::vector<double> positions_along(double reach, double spacing) {
  const int intervals = reach > 1e-9 * spacing ? static_cast<int>(std::ceil(2.0 * reach / spacing - 1e-9)) : 0;
  std::vector<double> positions(intervals + 1, 0.0);
  for (int i = 0; i <= intervals && intervals > 0; ++i) positions[i] = reach * (2.0 * i / intervals - 1.0);
  return positions;
}

bool at_end(std::size_t index, const std::vector<double>& positions) {
  return index == 0 || index + 1 == positions.size();
}

std::vector<CoveringSphere> cover_box(const Vec3& size, double spacing, double radius) {
  const std::vector<double> x = positions_along(0.5 * size.x() - radius, spacing);
  const std::vector<double> y = positions_along(0.5 * size.y() - radius, spacing);
  const std::vector<double> z = positions_along(0.5 * size.z() - radius, spacing);
  std::vector<CoveringSphere> spheres;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < y.size(); ++j) {
      for (std::size_t k = 0; k < z.size(); ++k) {
        if (at_end(i, x) || at_end(j, y) || at_end(k, z)) spheres.push_back({Vec3(x[i], y[j], z[k]), radius});
      }
    }
  }
  return spheres;
}

std::vector<CoveringSphere> cover_cylinder(double cylinder_radius, double length, double spacing, double radius) {
  const double outer = cylinder_radius - radius;
  const std::vector<double> z = positions_along(0.5 * length - radius, spacing);
  const int rings = outer > 1e-9 * spacing ? static_cast<int>(std::ceil(outer / spacing - 1e-9)) : 0;
  std::vector<CoveringSphere> spheres;
  for (std::size_t k = 0; k < z.size(); ++k) {
    // Full discs at the two ends, the outermost ring alone between them.
    for (int i = rings; i >= (at_end(k, z) ? 0 : rings); --i) {
      const double r = rings > 0 ? outer * i / rings : 0.0;
      const double around = 2.0 * std::numbers::pi * r / spacing;
      const int count = i == 0 ? 1 : std::max(3, static_cast<int>(std::ceil(around - 1e-9)));
      for (int n = 0; n < count; ++n) {
        const double angle = 2.0 * std::numbers::pi * n / count;
        spheres.push_back({Vec3(r * std::cos(angle), r * std::sin(angle), z[k]), radius});
      }
    }
  }
  return spheres;
}

}  // namespace

std::vector<CoveringSphere> Shape::covering_spheres(double spacing, double radius) const {
  if (kind == ShapeKind::sphere) return {{Vec3::Zero(), size.x()}};
  const double thickness = kind == ShapeKind::box ? size.minCoeff() : std::min(2.0 * size.x(), size.y());
  if (!(spacing > 0) || radius < 0 || radius > 0.5 * thickness * (1 + 1e-12)) {
    throw InputError(
        fmt::format("shape '{}': covering spheres need a spacing > 0 and a radius of at most half the "
                    "smallest extent ({} m), not {} m and {} m",
                    name, 0.5 * thickness, spacing, radius));
  }
  if (radius == 0) radius = 0.5 * thickness / static_cast<double>(std::max(1L, std::lround(thickness / spacing)));
  if (kind == ShapeKind::box) return cover_box(size, spacing, radius);
  return cover_cylinder(size.x(), size.y(), spacing, radius);
}

}  // namespace embacle::coupling
