#include "core/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace embacle::mps {

namespace {

Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec3d plus(const Vec3d& a, double share, const Vec3d& b) {
  return {a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]};
}
double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3d unit(const Vec3d& a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? Vec3d{a[0] / length, a[1] / length, a[2] / length} : a;
}

constexpr int most_cells = 64;  ///< along the longest side

}  // namespace

Mesh::Mesh(const std::vector<Triangle>& triangles) {
  std::map<Vec3d, Vec3d> corner_normal;
  std::map<std::pair<Vec3d, Vec3d>, Vec3d> edge_normal;  // either direction under the sorted pair
  const auto edge_of = [](const Vec3d& a, const Vec3d& b) { return std::pair(std::min(a, b), std::max(a, b)); };
  for (const Triangle& triangle : triangles) {
    Face face{triangle.corner, {}, {}, {}};
    const auto& p = face.corner;
    face.normal = unit(cross(minus(p[1], p[0]), minus(p[2], p[0])));
    for (int k = 0; k < 3; ++k) {
      const Vec3d ahead = unit(minus(p[(k + 1) % 3], p[k])), back = unit(minus(p[(k + 2) % 3], p[k]));
      const double angle = std::acos(std::clamp(dot(ahead, back), -1.0, 1.0));
      Vec3d& at_corner = corner_normal[p[k]];
      at_corner = plus(at_corner, angle, face.normal);
      Vec3d& at_edge = edge_normal[edge_of(p[k], p[(k + 1) % 3])];
      at_edge = plus(at_edge, 1, face.normal);
    }
    faces_.push_back(face);
  }
  Vec3d upper = faces_.front().corner[0];
  lower_ = upper;
  for (Face& face : faces_) {
    for (int k = 0; k < 3; ++k) {
      face.corner_normal[k] = unit(corner_normal[face.corner[k]]);
      face.edge_normal[k] = unit(edge_normal[edge_of(face.corner[k], face.corner[(k + 1) % 3])]);
      for (int c = 0; c < 3; ++c) {
        lower_[c] = std::min(lower_[c], face.corner[k][c]);
        upper[c] = std::max(upper[c], face.corner[k][c]);
      }
    }
  }
  double longest = 0;
  for (int c = 0; c < 3; ++c) longest = std::max(longest, upper[c] - lower_[c]);
  const double wanted = std::clamp(std::sqrt(static_cast<double>(faces_.size())), 4.0, double{most_cells});
  cell_ = longest / wanted;
  for (int c = 0; c < 3; ++c) cells_[c] = static_cast<int>((upper[c] - lower_[c]) / cell_) + 1;
  const auto for_cells = [&](const Face& face, auto&& visit) {
    std::array<int, 3> low{}, high{};
    for (int c = 0; c < 3; ++c) {
      const auto [least, most] = std::minmax({face.corner[0][c], face.corner[1][c], face.corner[2][c]});
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
  for (const Face& face : faces_) for_cells(face, [&](int cell) { ++first_[cell + 1]; });
  for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  listed_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t f = 0; f < faces_.size(); ++f) for_cells(faces_[f], [&](int cell) { listed_[next[cell]++] = f; });
}

int Mesh::cell_along(int axis, double x) const {
  return static_cast<int>(std::clamp((x - lower_[axis]) / cell_, 0.0, cells_[axis] - 1.0));
}

/// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
Vec3d Mesh::nearest(const Face& face, const Vec3d& x, const Vec3d*& normal) {
  const auto& [a, b, c] = face.corner;
  const auto at_corner = [&](int k) {
    normal = &face.corner_normal[k];
    return face.corner[k];
  };
  const Vec3d ab = minus(b, a), ac = minus(c, a), ap = minus(x, a);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return at_corner(0);
  const Vec3d bp = minus(x, b);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return at_corner(1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    normal = &face.edge_normal[0];
    return plus(a, d1 / (d1 - d3), ab);
  }
  const Vec3d cp = minus(x, c);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return at_corner(2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    normal = &face.edge_normal[2];
    return plus(a, d2 / (d2 - d6), ac);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    normal = &face.edge_normal[1];
    return plus(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b));
  }
  normal = &face.normal;
  const double sum = va + vb + vc;
  return plus(plus(a, vb / sum, ab), vc / sum, ac);
}

double Mesh::distance(const double* place, Vec3d* out) const {
  const Vec3d x{place[0], place[1], place[2]};
  std::array<int, 3> centre{};
  for (int c = 0; c < 3; ++c) centre[c] = cell_along(c, x[c]);
  double best = 1e300;
  Vec3d foot{};
  const Vec3d* deciding = nullptr;
  const auto visit = [&](int i, int j, int k) {
    const std::size_t cell = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0] + i;
    for (std::uint32_t n = first_[cell]; n < first_[cell + 1]; ++n) {
      const Vec3d* normal = nullptr;
      const Vec3d point = nearest(faces_[listed_[n]], x, normal);
      const Vec3d arm = minus(x, point);
      const double square = dot(arm, arm);
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
  const Vec3d arm = minus(x, foot);
  const double length = std::sqrt(best);
  const bool outside = dot(arm, *deciding) >= 0;
  if (out != nullptr) {
    *out = length > 1e-12 * cell_ ? plus({}, (outside ? 1 : -1) / length, arm) : *deciding;
  }
  return outside ? length : -length;
}

}  // namespace embacle::mps
