// How far a covering is from its shape.
#include "covering_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cells.hpp"

namespace embacle::coupling {

SurfaceGaps surface_gaps(const Shape& shape, const std::vector<CoveringSphere>& spheres, double spacing) {
  SurfaceGaps gaps;
  double area_sum = 0;
  shape.visit_surface(spacing, [&](const Vec3& place, const Vec3& area) {
    double gap = std::numeric_limits<double>::infinity();
    for (const CoveringSphere& sphere : spheres) {
      gap = std::min(gap, (place - sphere.centre).norm() - sphere.radius);
    }
    gap = std::max(gap, 0.0);
    gaps.largest = std::max(gaps.largest, gap);
    gaps.mean += gap * area.norm();
    area_sum += area.norm();
  });
  gaps.mean /= area_sum;
  return gaps;
}

CoveringError Shape::covering_error(const std::vector<CoveringSphere>& spheres) const {
  if (spheres.empty()) throw InputError("a covering needs spheres");
  constexpr double most_parts = 20000;
  const int places = kind == ShapeKind::surface ? 1 << 16 : 1 << 18;
  CoveringError error;
  const double volume = mass_properties().volume;
  error.size = std::cbrt(volume);
  double smallest = spheres.front().radius, largest = smallest;
  Box box = extents(Quaternion::Identity());
  for (const CoveringSphere& sphere : spheres) {
    smallest = std::min(smallest, sphere.radius);
    largest = std::max(largest, sphere.radius);
    box.lower = box.lower.cwiseMin((sphere.centre.array() - sphere.radius).matrix());
    box.upper = box.upper.cwiseMax((sphere.centre.array() + sphere.radius).matrix());
    error.largest_protrusion = std::max(error.largest_protrusion, signed_distance(sphere.centre) + sphere.radius);
  }
  const SurfaceGaps gaps =
      surface_gaps(*this, spheres, std::max(0.25 * smallest, std::sqrt(surface_area() / most_parts)));
  error.largest_gap = gaps.largest;
  error.mean_gap = gaps.mean;

  Cells centres(largest);
  for (const CoveringSphere& sphere : spheres) centres.add(sphere.centre);
  const Vec3 edges = box.upper - box.lower;
  // Multiples of powers of 1 / 1.2207..., the root of x^4 = x + 1: no plane through the box holds more than its share.
  const double base = 1 / 1.2207440846057596;
  const Vec3 stride(base, base * base, base * base * base);
  std::size_t outside = 0, missing = 0;
  Vec3 share = Vec3::Constant(0.5);
  for (int k = 0; k < places; ++k) {
    for (int c = 0; c < 3; ++c) {
      share[c] += stride[c];
      share[c] -= std::floor(share[c]);
    }
    const Vec3 place = box.lower + share.cwiseProduct(edges);
    bool covered = false;
    centres.visit(place, largest, [&](std::size_t s) {
      covered = covered || (place - spheres[s].centre).squaredNorm() < spheres[s].radius * spheres[s].radius;
    });
    if (covered && error.largest_protrusion <= 1e-8 * largest) continue;
    const double distance = signed_distance(place);
    if (distance <= -largest) continue;
    outside += covered && distance > 1e-9 * largest ? 1 : 0;
    missing += !covered && distance <= 0 ? 1 : 0;
  }
  const double of_each = edges.prod() / places / volume;
  error.outside_volume = of_each * static_cast<double>(outside);
  error.missing_volume = of_each * static_cast<double>(missing);
  return error;
}

}  // namespace embacle::coupling
