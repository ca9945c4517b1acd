#include "embacle/coupling/closed_surface.hpp"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace embacle::coupling {

namespace {

using Key = std::array<double, 3>;
Key key_of(const Vec3& place) { return {place.x(), place.y(), place.z()}; }

Vec3 unit(const Vec3& a) {
  const double length = a.norm();
  return length > 0 ? Vec3(a / length) : a;
}

Vec3 area_of(const Triangle& t) { return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]); }

constexpr std::uint32_t leaf_size = 4;

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
  std::set<Key> sharp;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& place = triangles_[f][k];
      const bool turns = faces_[f].normal.dot(faces_[f].corner_normal[k]) < std::numbers::sqrt3 / 2;
      if (turns && sharp.insert(key_of(place)).second) sharp_corners_.push_back(place);
    }
  }
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(triangles_.size());
  build(0, static_cast<std::uint32_t>(order_.size()));
}

std::uint32_t ClosedSurface::build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Box box{triangles_[order_[begin]][0], triangles_[order_[begin]][0]};
  for (std::uint32_t k = begin; k < end; ++k) {
    for (const Vec3& corner : triangles_[order_[k]]) {
      box.lower = box.lower.cwiseMin(corner);
      box.upper = box.upper.cwiseMax(corner);
    }
  }
  nodes_.push_back({box, begin, end, 0});
  if (end - begin <= leaf_size) return index;
  int axis = 0;
  (box.upper - box.lower).maxCoeff(&axis);
  const auto middle_of = [&](std::uint32_t f) {
    return triangles_[f][0][axis] + triangles_[f][1][axis] + triangles_[f][2][axis];
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return middle_of(a) < middle_of(b); });
  build(begin, middle);
  const std::uint32_t right = build(middle, end);
  nodes_[index].right = right;
  return index;
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

struct ClosedSurface::Nearest {
  Vec3 place;
  double square = std::numeric_limits<double>::infinity();
  Vec3 foot = Vec3::Zero();
  const Vec3* normal = nullptr;  ///< that decides the sign

  [[nodiscard]] double square_to(const Box& box) const {
    return (box.lower - place).cwiseMax(place - box.upper).cwiseMax(0.0).squaredNorm();
  }
};

void ClosedSurface::search(std::uint32_t index, Nearest& best) const {
  const Node& node = nodes_[index];
  if (node.right == 0) {
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const Vec3* normal = nullptr;
      const Vec3 point = nearest(order_[k], best.place, normal);
      const double square = (best.place - point).squaredNorm();
      if (square >= best.square) continue;
      best.square = square;
      best.foot = point;
      best.normal = normal;
    }
    return;
  }
  std::uint32_t near = index + 1, far = node.right;
  double to_near = best.square_to(nodes_[near].box), to_far = best.square_to(nodes_[far].box);
  if (to_far < to_near) {
    std::swap(near, far);
    std::swap(to_near, to_far);
  }
  if (to_near < best.square) search(near, best);
  if (to_far < best.square) search(far, best);
}

double ClosedSurface::distance(const Vec3& place, Vec3* normal) const {
  Nearest best;
  best.place = place;
  search(0, best);
  const Vec3 arm = place - best.foot;
  const double length = std::sqrt(best.square);
  const bool outside = arm.dot(*best.normal) >= 0;
  if (normal != nullptr) {
    const double negligible = 1e-14 * (bounds_.upper - bounds_.lower).maxCoeff();
    *normal = length > negligible ? Vec3((outside ? 1 : -1) / length * arm) : *best.normal;
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
