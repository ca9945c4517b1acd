#include "polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace embacle::coupling {

namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the area of a triangle, positive if counterclockwise.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - b); }

double distance_to_segment(const Vec2& place, const Vec2& a, const Vec2& b) {
  const double share = std::clamp((place - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (place - a - share * (b - a)).norm();
}

bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double tolerance) {
  const auto sides = [](const Vec2& p, const Vec2& q, const Vec2& r) { return turn(p, q, r) > 0; };
  if (sides(a, b, c) != sides(a, b, d) && sides(c, d, a) != sides(c, d, b)) return true;
  return std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d), distance_to_segment(c, a, b),
                   distance_to_segment(d, a, b)}) <= tolerance;
}

}  // namespace

std::vector<Vec2> checked_polygon(const std::vector<Vec2>& corners) {
  const std::size_t n = corners.size();
  if (n < 3) throw InputError(fmt::format("a polygon needs at least 3 corners, not {}", n));
  Vec2 lower = corners[0], upper = corners[0];
  for (const Vec2& corner : corners) {
    lower = lower.cwiseMin(corner);
    upper = upper.cwiseMax(corner);
  }
  const double tolerance = 1e-9 * (upper - lower).norm();
  for (std::size_t i = 0; i < n; ++i) {
    if ((corners[i] - corners[(i + 1) % n]).norm() <= tolerance) {
      throw InputError(fmt::format("corners {} and {} of the polygon are at the same place", i + 1, (i + 1) % n + 1));
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const std::size_t i1 = (i + 1) % n, j1 = (j + 1) % n;
      bool bad = false;
      if (i1 == j || j1 == i) {  // neighbours: the far corners must not lie on the other edge
        bad = distance_to_segment(i1 == j ? corners[j1] : corners[j], corners[i], corners[i1]) <= tolerance ||
              distance_to_segment(i1 == j ? corners[i] : corners[i1], corners[j], corners[j1]) <= tolerance;
      } else {
        bad = meet(corners[i], corners[i1], corners[j], corners[j1], tolerance);
      }
      if (bad) {
        throw InputError(fmt::format(
            "the polygon's edge from corner {} to {} meets the one from {} to {}; allowed: polygons that neither cross "
            "nor touch themselves",
            i + 1, i1 + 1, j + 1, j1 + 1));
      }
    }
  }
  std::vector<Vec2> result;
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &before = corners[(i + n - 1) % n], &here = corners[i], &after = corners[(i + 1) % n];
    area += cross(here - lower, after - lower);
    if (distance_to_segment(here, before, after) > tolerance) result.push_back(here);
  }
  if (area < 0) std::reverse(result.begin(), result.end());
  return result;
}

std::vector<std::array<int, 3>> triangulate(const std::vector<Vec2>& polygon) {
  std::vector<int> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  std::vector<std::array<int, 3>> result;
  while (left.size() > 3) {
    // Of all ears the one with the largest smallest angle: no slivers where they can be avoided.
    std::size_t best = left.size();
    double widest = -1;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const int i = left[(k + left.size() - 1) % left.size()], j = left[k], l = left[(k + 1) % left.size()];
      const Vec2 &a = polygon[i], &b = polygon[j], &c = polygon[l];
      const double area = turn(a, b, c);
      if (area <= 0) continue;
      const bool empty = std::none_of(left.begin(), left.end(), [&](int other) {
        if (other == i || other == j || other == l) return false;
        const Vec2& p = polygon[other];
        return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
      });
      if (!empty) continue;
      const double longest = std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
      if (area / longest > widest) {
        widest = area / longest;
        best = k;
      }
    }
    if (best == left.size()) throw std::logic_error("a simple polygon has an ear");
    const std::size_t size = left.size();
    result.push_back({left[(best + size - 1) % size], left[best], left[(best + 1) % size]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  result.push_back({left[0], left[1], left[2]});
  return result;
}

double polygon_distance(const std::vector<Vec2>& polygon, const Vec2& place, Vec2* normal) {
  double best = std::numeric_limits<double>::infinity();
  Vec2 foot = place, edge = Vec2::UnitX();
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const Vec2 along = b - a;
    const double share = std::clamp((place - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Vec2 nearest = a + share * along;
    const double square = (place - nearest).squaredNorm();
    if (square < best) {
      best = square;
      foot = nearest;
      edge = along;
    }
    const bool crosses = (a.y() > place.y()) != (b.y() > place.y());
    if (crosses && place.x() < a.x() + (place.y() - a.y()) / along.y() * along.x()) inside = !inside;
  }
  const double distance = std::sqrt(best);
  const double sign = inside ? -1 : 1;
  if (normal != nullptr) {
    *normal = distance > 1e-9 * edge.norm() ? Vec2(sign * (place - foot) / distance)
                                            : Vec2(Vec2(edge.y(), -edge.x()).normalized());
  }
  return sign * distance;
}

}  // namespace embacle::coupling
