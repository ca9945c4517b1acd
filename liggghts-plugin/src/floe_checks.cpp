#include "floe_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace embacle::liggghts {

using coupling::Mat3;
using coupling::ShapeKind;
using coupling::Vec3;

namespace {

constexpr double negligible = 1e-9;  // of a body's size: round-off of positions given in decimal

double box_overlap(const PlacedFloe& a, const PlacedFloe& b) {
  const Mat3 axes_a = a.state.orientation.toRotationMatrix();
  const Mat3 axes_b = b.state.orientation.toRotationMatrix();
  const Vec3 half_a = 0.5 * a.shape->shape.size;
  const Vec3 half_b = 0.5 * b.shape->shape.size;
  const Vec3 apart = b.state.position - a.state.position;
  double depth = std::numeric_limits<double>::infinity();
  const auto project = [&](Vec3 axis) {
    const double length = axis.norm();
    if (length < 1e-9) return;  // parallel edges: a face axis covers them
    axis /= length;
    const double reach =
        half_a.dot((axes_a.transpose() * axis).cwiseAbs()) + half_b.dot((axes_b.transpose() * axis).cwiseAbs());
    depth = std::min(depth, reach - std::abs(axis.dot(apart)));
  };
  for (int i = 0; i < 3; ++i) {
    project(axes_a.col(i));
    project(axes_b.col(i));
    for (int j = 0; j < 3; ++j) project(axes_a.col(i).cross(axes_b.col(j)));
  }
  return depth;
}

/// Corners, face normals and edge directions of a prism or a solid of triangles, or of a box, in the global frame.
struct Facets {
  std::vector<Vec3> corners, normals, edges;

  explicit Facets(const PlacedFloe& floe) {
    const auto add_direction = [](std::vector<Vec3>& directions, Vec3 d) {
      const double length = d.norm();
      if (length == 0) return;
      d /= length;
      if (std::ranges::none_of(directions, [&](const Vec3& other) { return std::abs(other.dot(d)) > 1 - 1e-12; }))
        directions.push_back(d);
    };
    const auto& shape = floe.shape->shape;
    const Mat3 axes = floe.state.orientation.toRotationMatrix();
    if (!shape.polyhedron) {
      for (int k = 0; k < 8; ++k) {
        const Vec3 sign(k & 1 ? 0.5 : -0.5, k & 2 ? 0.5 : -0.5, k & 4 ? 0.5 : -0.5);
        corners.emplace_back(floe.state.position + axes * sign.cwiseProduct(shape.size));
      }
      for (int k = 0; k < 3; ++k) normals.emplace_back(axes.col(k));
      edges = normals;
      return;
    }
    for (const coupling::Triangle& triangle : shape.polyhedron->surface.triangles()) {
      for (int k = 0; k < 3; ++k) {
        corners.emplace_back(floe.state.position + axes * triangle[k]);
        add_direction(edges, axes * (triangle[(k + 1) % 3] - triangle[k]));
      }
      add_direction(normals, axes * (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]));
    }
  }
};

/// Least overlap along the axes that can separate two convex bodies; of others, of their hulls.
double hull_overlap(const PlacedFloe& one, const PlacedFloe& other) {
  const Facets a(one), b(other);
  double depth = std::numeric_limits<double>::infinity();
  const auto project = [&](const Vec3& axis) {
    const double length = axis.norm();
    if (length < 1e-9) return;
    double low[2], high[2];
    int side = 0;
    for (const auto* corners : {&a.corners, &b.corners}) {
      low[side] = std::numeric_limits<double>::infinity();
      high[side] = -low[side];
      for (const Vec3& corner : *corners) {
        low[side] = std::min(low[side], axis.dot(corner));
        high[side] = std::max(high[side], axis.dot(corner));
      }
      ++side;
    }
    depth = std::min(depth, std::min(high[0] - low[1], high[1] - low[0]) / length);
  };
  for (const auto* normals : {&a.normals, &b.normals}) {
    for (const Vec3& normal : *normals) project(normal);
  }
  for (std::size_t i = 0; i < a.edges.size() && depth > 0; ++i) {
    for (const Vec3& edge : b.edges) project(a.edges[i].cross(edge));
  }
  return depth;
}

/// Whether a shape has flat faces and is known to be convex.
bool convex(const coupling::Shape& shape) {
  if (shape.kind == ShapeKind::box) return true;
  if (shape.kind != ShapeKind::prism) return false;
  const auto& corners = shape.polyhedron->polygon;
  bool left = false, right = false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d before = corners[(k + 1) % corners.size()] - corners[k];
    const Eigen::Vector2d after = corners[(k + 2) % corners.size()] - corners[(k + 1) % corners.size()];
    const double turn = before.x() * after.y() - before.y() * after.x();
    (turn > 0 ? left : right) = true;
  }
  return left != right;
}

bool flat(const coupling::Shape& shape) { return shape.kind == ShapeKind::box || shape.polyhedron; }

double sphere_overlap(const PlacedFloe& a, const PlacedFloe& b) {
  double depth = -std::numeric_limits<double>::infinity();
  for (const auto& one : a.shape->spheres) {
    const Vec3 centre = a.state.position + a.state.orientation * one.centre;
    for (const auto& other : b.shape->spheres) {
      const Vec3 other_centre = b.state.position + b.state.orientation * other.centre;
      depth = std::max(depth, one.radius + other.radius - (centre - other_centre).norm());
    }
  }
  return depth;
}

}  // namespace

double overlap_depth(const PlacedFloe& a, const PlacedFloe& b) {
  const double reach = a.shape->shape.bounding_radius() + b.shape->shape.bounding_radius();
  const double clearance = (a.state.position - b.state.position).norm() - reach;
  if (clearance > 0) return -clearance;
  const bool boxes = a.shape->shape.kind == ShapeKind::box && b.shape->shape.kind == ShapeKind::box;
  if (boxes) return box_overlap(a, b);
  if (!flat(a.shape->shape) || !flat(b.shape->shape)) return sphere_overlap(a, b);
  const double depth = hull_overlap(a, b);
  return depth <= 0 || (convex(a.shape->shape) && convex(b.shape->shape)) ? depth : sphere_overlap(a, b);
}

void check_overlaps(const std::string& where, const std::vector<PlacedFloe>& floes, std::size_t first_new) {
  // Sweep along x: only bodies whose extents along x meet are compared.
  std::vector<double> left(floes.size()), right(floes.size());
  for (std::size_t i = 0; i < floes.size(); ++i) {
    const coupling::Box extents = floes[i].shape->shape.extents(floes[i].state.orientation);
    left[i] = floes[i].state.position.x() + extents.lower.x();
    right[i] = floes[i].state.position.x() + extents.upper.x();
  }
  std::vector<std::size_t> order(floes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return left[a] < left[b]; });
  double deepest = 0;
  std::size_t first = 0, second = 0, pairs = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (std::size_t l = k + 1; l < order.size() && left[order[l]] <= right[order[k]]; ++l) {
      const std::size_t a = std::min(order[k], order[l]), b = std::max(order[k], order[l]);
      if (b < first_new) continue;
      const double depth = overlap_depth(floes[a], floes[b]);
      const double size = std::min(floes[a].shape->shape.bounding_radius(), floes[b].shape->shape.bounding_radius());
      if (depth <= negligible * size) continue;
      ++pairs;
      if (depth > deepest) {
        deepest = depth;
        first = a;
        second = b;
      }
    }
  }
  if (pairs == 0) return;
  const auto place = [&](std::size_t i) {
    const Vec3& p = floes[i].state.position;
    return fmt::format("{} at ({:g}, {:g}, {:g}) m", floes[i].origin, p.x(), p.y(), p.z());
  };
  throw coupling::InputError(
      fmt::format("{}: {} pair(s) of bodies overlap; the deepest overlap is {:.3g} m, between {} and {}", where, pairs,
                  deepest, place(first), place(second)));
}

void check_inside(const std::string& where, const std::vector<PlacedFloe>& floes, const coupling::Box& box,
                  const std::array<bool, 3>& periodic) {
  double farthest = 0;
  std::string message;
  for (const PlacedFloe& floe : floes) {
    const coupling::Box extents = floe.shape->shape.extents(floe.state.orientation);
    const double allowed = negligible * floe.shape->shape.bounding_radius();
    for (int k = 0; k < 3; ++k) {
      if (periodic[k]) continue;
      const double low = floe.state.position[k] + extents.lower[k], high = floe.state.position[k] + extents.upper[k];
      const double out = std::max(box.lower[k] - low, high - box.upper[k]);
      if (out <= allowed || out <= farthest) continue;
      farthest = out;
      message = fmt::format("{}: {} reaches from {} = {:g} to {:g} m, but the simulation box only from {:g} to {:g} m",
                            where, floe.origin, "xyz"[k], low, high, box.lower[k], box.upper[k]);
    }
  }
  if (!message.empty()) throw coupling::InputError(message);
}

}  // namespace embacle::liggghts
