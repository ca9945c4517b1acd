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
  return boxes ? box_overlap(a, b) : sphere_overlap(a, b);
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
