#include "embacle/coupling/closed_surface.hpp"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <map>

namespace embacle::coupling {

namespace {

using Key = std::array<double, 3>;
Key key_of(const Vec3& place) { return {place.x(), place.y(), place.z()}; }

Vec3 unit(const Vec3& a) {
  const double length = a.norm();
  return length > 0 ? Vec3(a / length) : a;
}

Vec3 area_of(const Triangle& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]); }

constexpr double most_cells = 64;      ///< along the longest side
constexpr std::size_t few_faces = 40;  ///< so few are compared one by one

}  // namespace

ClosedSurface::ClosedSurface(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  std::map<Key, Vec3> corner_normal;
  std::map<std::pair<Key, Key>, Vec3> edge_normal;  // either direction under the sorted pair
  const auto edge_of = [](const Vec3& a, const Vec3& b) {
    return std::pair(std::min(key_of(a), key_of(b)), std::max(key_of(a), key_of(b)));
  };
  const auto add = [](auto& normals, const auto& key, const Vec3& normal) {
    normals.try_emplace(key, Vec3::Zero()).first->second += normal;
  };
  bounds_ = {triangles_.front()[0], triangles_.front()[0]};
  faces_.resize(triangles_.size());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Triangle& p = triangles_[f];
    Face& face = faces_[f];
    face.normal = unit(area_of(p));
    for (int k = 0; k < 3; ++k) {
      const Vec3 ahead = unit(p[(k + 1) % 3] - p[k]), back = unit(p[(k + 2) % 3] - p[k]);
      add(corner_normal, key_of(p[k]), std::acos(std::clamp(ahead.dot(back), -1.0, 1.0)) * face.normal);
      add(edge_normal, edge_of(p[k], p[(k + 1) % 3]), face.normal);
      bounds_.lower = bounds_.lower.cwiseMin(p[k]);
      bounds_.upper = bounds_.upper.cwiseMax(p[k]);
    }
  }
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Triangle& p = triangles_[f];
      faces_[f].corner_normal[k] = unit(corner_normal.at(key_of(p[k])));
      faces_[f].edge_normal[k] = unit(edge_normal.at(edge_of(p[k], p[(k + 1) % 3])));
    }
  }
  const Vec3 size = bounds_.upper - bounds_.lower;
  const double wanted =
      faces_.size() <= few_faces ? 1 : std::clamp(std::sqrt(static_cast<double>(faces_.size())), 4.0, most_cells);
  cell_ = size.maxCoeff() / wanted;
  for (int c = 0; c < 3; ++c) cells_[c] = faces_.size() <= few_faces ? 1 : static_cast<int>(size[c] / cell_) + 1;
  const auto for_cells = [&](const Triangle& p, auto&& visit) {
    std::array<int, 3> low{}, high{};
    for (int c = 0; c < 3; ++c) {
      const auto [least, most] = std::minmax({p[0][c], p[1][c], p[2][c]});
      low[c] = cell_along(c, least);
      high[c] = cell_along(c, most);
    }
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        for (int i = low[0]; i <= high[0]; ++i) visit((k * cells_[1] + j) * cells_[0] + i);
      }
    }
  };
  first_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2] + 1, 0);
  for (const Triangle& p : triangles_) for_cells(p, [&](int cell) { ++first_[cell + 1]; });
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  listed_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    for_cells(triangles_[f], [&](int cell) { listed_[next[cell]++] = f; });
  }
}

int ClosedSurface::cell_along(int axis, double x) const {
  return static_cast<int>(std::clamp((x - bounds_.lower[axis]) / cell_, 0.0, cells_[axis] - 1.0));
}

double ClosedSurface::area() const {
  double sum = 0;
  for (const Triangle& triangle : triangles_) sum += area_of(triangle).norm();
  return sum;
}

/// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
Vec3 ClosedSurface::nearest(std::size_t f, const Vec3& x, const Vec3*& normal) const {
  const auto& [a, b, c] = triangles_[f];
  const Face& face = faces_[f];
  const auto at_corner = [&](int k) {
    normal = &face.corner_normal[k];
    return triangles_[f][k];
  };
  const Vec3 ab = b - a, ac = c - a, ap = x - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return at_corner(0);
  const Vec3 bp = x - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return at_corner(1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    normal = &face.edge_normal[0];
    return a + d1 / (d1 - d3) * ab;
  }
  const Vec3 cp = x - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return at_corner(2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    normal = &face.edge_normal[2];
    return a + d2 / (d2 - d6) * ac;
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    normal = &face.edge_normal[1];
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  normal = &face.normal;
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

double ClosedSurface::distance(const Vec3& x, Vec3* out) const {
  std::array<int, 3> centre{};
  for (int c = 0; c < 3; ++c) centre[c] = cell_along(c, x[c]);
  double best = 1e300;
  Vec3 foot = Vec3::Zero();
  const Vec3* deciding = nullptr;
  const auto visit = [&](int i, int j, int k) {
    const std::size_t cell = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0] + i;
    for (std::uint32_t n = first_[cell]; n < first_[cell + 1]; ++n) {
      const Vec3* normal = nullptr;
      const Vec3 point = nearest(listed_[n], x, normal);
      const double square = (x - point).squaredNorm();
      if (square >= best) continue;
      best = square;
      foot = point;
      deciding = normal;
    }
  };
  // Shells of cells around that of the place: what lies in later shells is at least `shell` cells away.
  const int last = std::max({cells_[0], cells_[1], cells_[2]});
  for (int shell = 0; shell <= last; ++shell) {
    if (best <= std::pow((shell - 1) * cell_, 2) && shell > 0) break;
    for (int k = std::max(0, centre[2] - shell); k <= std::min(cells_[2] - 1, centre[2] + shell); ++k) {
      for (int j = std::max(0, centre[1] - shell); j <= std::min(cells_[1] - 1, centre[1] + shell); ++j) {
        const bool rim = std::abs(k - centre[2]) == shell || std::abs(j - centre[1]) == shell;
        for (int i = std::max(0, centre[0] - shell); i <= std::min(cells_[0] - 1, centre[0] + shell); ++i) {
          if (rim || std::abs(i - centre[0]) == shell) visit(i, j, k);
        }
      }
    }
  }
  const Vec3 arm = x - foot;
  const double length = std::sqrt(best);
  const bool outside = arm.dot(*deciding) >= 0;
  if (out != nullptr) {
    *out = length > 1e-12 * cell_ ? Vec3((outside ? 1 : -1) / length * arm) : *deciding;
  }
  return outside ? length : -length;
}

SolidMoments solid_moments(const std::vector<Triangle>& triangles) {
  Vec3 lower = triangles.front()[0], upper = lower;
  for (const Triangle& t : triangles) {
    for (const Vec3& corner : t) {
      lower = lower.cwiseMin(corner);
      upper = upper.cwiseMax(corner);
    }
  }
  const Vec3 origin = 0.5 * (lower + upper);  // near the body: no differences of large numbers
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const Triangle& t : triangles) {
    const Vec3 a = t[0] - origin, b = t[1] - origin, c = t[2] - origin, sum = a + b + c;
    const double tetrahedron = a.dot(b.cross(c)) / 6;
    volume += tetrahedron;
    first += tetrahedron / 4 * sum;
    second += tetrahedron / 20 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  SolidMoments result;
  result.volume = volume;
  const Vec3 centre = first / volume;
  result.centre = origin + centre;
  second -= volume * centre * centre.transpose();
  result.inertia = second.trace() * Mat3::Identity() - second;
  return result;
}

Mat3 principal_axes(const Mat3& tensor) {
  Mat3 turned = 0.5 * (tensor + tensor.transpose());
  Mat3 axes = Mat3::Identity();
  const double negligible = 1e-12 * std::abs(turned.trace());
  for (bool diagonal = false; !diagonal;) {
    diagonal = true;
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      if (!(std::abs(turned(p, q)) > negligible)) continue;
      diagonal = false;
      Eigen::JacobiRotation<double> rotation;
      rotation.makeJacobi(turned, p, q);
      turned.applyOnTheLeft(p, q, rotation.adjoint());
      turned.applyOnTheRight(p, q, rotation);
      axes.applyOnTheRight(p, q, rotation);
    }
  }
  return axes;
}

void divide(const Triangle& triangle, double largest, const std::function<void(const Vec3&, const Vec3&)>& visit) {
  int longest = 0;
  double square = 0;
  for (int k = 0; k < 3; ++k) {
    const double edge = (triangle[(k + 1) % 3] - triangle[k]).squaredNorm();
    if (edge <= square) continue;
    square = edge;
    longest = k;
  }
  if (square <= largest * largest) {
    visit((triangle[0] + triangle[1] + triangle[2]) / 3, area_of(triangle));
    return;
  }
  const Vec3 &a = triangle[longest], &b = triangle[(longest + 1) % 3], &c = triangle[(longest + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  divide({a, middle, c}, largest, visit);
  divide({middle, b, c}, largest, visit);
}

}  // namespace embacle::coupling
