// Covering spheres of the shapes for contacts: inscribed, so that they touch the faces from inside. Boxes and cylinders
// have lattices; prisms and solids of triangles places at one depth, chosen farthest from each other.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cells.hpp"
#include "covering_error.hpp"
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

/// Moves a centre to the depth `radius` below all faces near it, into the corner where they are several. False if there
/// is no room for a sphere.
bool settle(const ClosedSurface& surface, double radius, Vec3& centre) {
  double before = radius;
  for (int pass = 0; pass < 400; ++pass) {
    Vec3 normal;
    const double excess = surface.distance(centre, &normal) + radius;
    if (std::abs(excess) <= 1e-9 * radius) return true;
    if (pass % 16 == 15) {  // to and fro over the middle of a thin part, or a corner of less than 20 degrees
      if (std::abs(excess) > 0.5 * before) return false;
      before = std::abs(excess);
    }
    centre -= excess * normal;
  }
  return false;
}

/// Where spheres can be: below the parts of the surface, inside.
struct Places {
  std::vector<Vec3> centres;
  std::vector<bool> at_corner;
};

Places places_for(const Shape& shape, double radius, double spacing) {
  Places places;
  const ClosedSurface& surface = shape.polyhedron->surface;
  const double least = 0.25 * spacing;  // between places that are tried
  Cells tried(2 * least);
  std::vector<Vec3> tried_places;
  shape.visit_surface(spacing, [&](const Vec3& place, const Vec3& area) {
    const bool corner = area.isZero(0);
    bool near = false;  // a fine surface has more parts than are needed
    tried.visit(place, least,
                [&](std::size_t k) { near = near || (tried_places[k] - place).squaredNorm() < least * least; });
    if (near && !corner) return;
    tried.add(place);
    tried_places.push_back(place);
    Vec3 normal = area.normalized();
    if (corner) (void)surface.distance(place, &normal);
    Vec3 centre = place - radius * normal;
    if (!settle(surface, radius, centre)) return;
    places.centres.push_back(centre);
    places.at_corner.push_back(corner);
  });
  return places;
}

/// Chooses places one by one, each the farthest from those chosen, from the outermost on, until there are `most` or
/// none is farther than `hole` [m]. Corners go before others that are at most sqrt 2 farther.
std::vector<CoveringSphere> farthest_first(const Places& places, double radius, double hole, int most) {
  const std::vector<Vec3>& centres = places.centres;
  std::vector<CoveringSphere> chosen;
  std::vector<double> square(centres.size());
  std::transform(centres.begin(), centres.end(), square.begin(), [](const Vec3& place) { return place.squaredNorm(); });
  while (static_cast<int>(chosen.size()) < most && !centres.empty()) {
    std::size_t next = 0, corner = centres.size();
    for (std::size_t k = 0; k < centres.size(); ++k) {
      if (square[k] > square[next]) next = k;
      if (places.at_corner[k] && (corner == centres.size() || square[k] > square[corner])) corner = k;
    }
    if (!chosen.empty() && square[next] <= hole * hole) break;
    if (corner < centres.size() && square[corner] >= 0.5 * square[next]) next = corner;
    if (chosen.empty()) std::fill(square.begin(), square.end(), std::numeric_limits<double>::infinity());
    chosen.push_back({centres[next], radius});
    for (std::size_t k = 0; k < centres.size(); ++k) {
      square[k] = std::min(square[k], (centres[k] - centres[next]).squaredNorm());
    }
  }
  return chosen;
}

/// The covering of a prism or surface; `radius` 0 tries several.
std::vector<CoveringSphere> cover_polyhedron(const Shape& shape, double radius, double spacing, double hole, int most) {
  if (radius > 0) return farthest_first(places_for(shape, radius, spacing), radius, hole, most);
  std::vector<CoveringSphere> best;
  double smallest = std::numeric_limits<double>::infinity();
  const double largest = shape.inscribed_radius();
  for (int k = 0; k <= 6; ++k) {
    const double tried = largest * std::pow(2.0, -0.5 * k);
    auto spheres = farthest_first(places_for(shape, tried, spacing), tried, hole, most);
    if (spheres.empty()) continue;
    const double gap = surface_gaps(shape, spheres, spacing).largest;
    if (gap >= smallest) continue;
    smallest = gap;
    best = std::move(spheres);
  }
  return best;
}

}  // namespace

std::vector<CoveringSphere> Shape::covering_spheres(double spacing, double radius) const {
  if (kind == ShapeKind::sphere) return {{Vec3::Zero(), size.x()}};
  const double largest = inscribed_radius();
  if (!(spacing > 0) || radius < 0 || radius > largest * (1 + 1e-9)) {
    throw InputError(fmt::format(
        "shape '{}': covering spheres need a spacing > 0 and a radius of at most that of the largest sphere "
        "inside ({:g} m), not {} m and {} m",
        name, largest, spacing, radius));
  }
  if (radius == 0 && kind != ShapeKind::surface) {
    radius = largest / static_cast<double>(std::max(1L, std::lround(2 * largest / spacing)));
  }
  if (kind == ShapeKind::box) return cover_box(size, spacing, radius);
  if (kind == ShapeKind::cylinder) return cover_cylinder(size.x(), size.y(), spacing, radius);
  const double parts = std::min({spacing / 3, 0.5 * largest, radius > 0 ? radius : largest});
  return cover_polyhedron(*this, radius, parts, spacing / std::numbers::sqrt2, std::numeric_limits<int>::max());
}

std::vector<CoveringSphere> Shape::covering_spheres_of_count(int count, double radius) const {
  if (kind == ShapeKind::sphere && count > 0) return {{Vec3::Zero(), size.x()}};
  const double largest = inscribed_radius();
  if (count < 1 || radius < 0 || radius > largest * (1 + 1e-9)) {
    throw InputError(fmt::format(
        "shape '{}': a covering needs at least one sphere and a radius of at most that of the largest sphere "
        "inside ({:g} m), not {} and {} m",
        name, largest, count, radius));
  }
  if (kind == ShapeKind::prism || kind == ShapeKind::surface) {
    const double parts = std::min(std::sqrt(surface_area() / count) / 3, 0.5 * largest);
    return cover_polyhedron(*this, radius, parts, 1e-6 * largest, count);
  }
  // The finest lattice that has no more: from coarse to fine, then between the last two spacings.
  double coarse = 2 * bounding_radius(), fine = coarse;
  std::vector<CoveringSphere> best = covering_spheres(coarse, radius);
  if (static_cast<int>(best.size()) > count) {
    throw InputError(fmt::format("shape '{}': a covering needs at least {} spheres{}, not {}", name, best.size(),
                                 radius > 0 ? fmt::format(" of radius {} m", radius) : "", count));
  }
  const auto try_spacing = [&](double spacing) {
    auto spheres = covering_spheres(spacing, radius);
    const bool fits = static_cast<int>(spheres.size()) <= count;
    if (fits && spheres.size() >= best.size()) best = std::move(spheres);
    return fits;
  };
  while (try_spacing(fine)) {
    coarse = fine;
    fine *= 0.8;
    if (fine < 1e-6 * bounding_radius()) return best;
  }
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (coarse + fine);
    (try_spacing(middle) ? coarse : fine) = middle;
  }
  return best;
}

}  // namespace embacle::coupling
