#include "embacle/coupling/layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "cells.hpp"

namespace embacle::coupling {

namespace {

double level(int layer, double spacing) { return (layer + 0.5) * spacing; }

/// Whether a place that was `below` the surface and moved to the depth `wanted` has come nearer to another side.
bool beyond_the_middle(const Vec3& moved, double below, double wanted, const DistanceWithNormal& distance) {
  Vec3 normal = Vec3::Zero();
  return wanted > below && -distance(moved, normal) < below + 0.5 * (wanted - below);
}

}  // namespace

std::vector<LayerPoint> layer_points(const Box& bounds, const Vec3& cell, int dimension, double spacing, double depth,
                                     const DistanceWithNormal& distance, bool thin) {
  std::array<int, 3> count{1, 1, 1};
  for (int c = 0; c < dimension; ++c) {
    count[c] = std::max(1, static_cast<int>(std::ceil((bounds.upper[c] - bounds.lower[c]) / cell[c] - 1e-6)));
  }
  std::vector<LayerPoint> result;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        Vec3 x = bounds.lower + (Vec3(i, j, k).array() + 0.5).matrix().cwiseProduct(cell);
        if (dimension == 2) x.z() = 0;
        Vec3 normal = Vec3::Zero();
        const double below = -distance(x, normal);
        if (below <= 0) continue;
        const int layer = static_cast<int>(std::floor(below / spacing * (1 + 1e-9)));
        if (level(layer, spacing) > depth) continue;
        const Vec3 moved = x + (below - level(layer, spacing)) * normal;
        result.push_back({thin && beyond_the_middle(moved, below, level(layer, spacing), distance) ? x : moved, layer});
      }
    }
  }
  return result;
}

void even_out(std::vector<LayerPoint>& points, int dimension, double spacing, const DistanceWithNormal& distance) {
  const double reach = 0.95 * spacing;
  const auto depth_of = [&](const Vec3& place) {
    Vec3 normal = Vec3::Zero();
    return -distance(place, normal);
  };
  // Onto the layer again, or back where the body has no room there.
  const auto move = [&](LayerPoint& point, const Vec3& step) {
    const double wanted = level(point.layer, spacing);
    Vec3 place = point.position + step;
    for (int pass = 0; pass < 3; ++pass) {
      Vec3 normal = Vec3::Zero();
      const double below = -distance(place, normal);
      place += (below - wanted) * normal;
    }
    if (depth_of(place) >= std::min(depth_of(point.position), wanted - 0.01 * spacing)) point.position = place;
  };
  for (int pass = 0; pass < 12; ++pass) {
    Cells cells(spacing);
    for (const LayerPoint& point : points) cells.add(point.position);
    std::vector<Vec3> push(points.size(), Vec3::Zero());
    for (std::size_t i = 0; i < points.size(); ++i) {
      cells.visit(points[i].position, spacing, [&](std::size_t j) {
        const Vec3 apart = points[i].position - points[j].position;
        const double r = apart.norm();
        if (i == j || r >= reach) return;
        // Two at one place part along the axes, each in its own direction.
        const Vec3 direction = r > 1e-9 * spacing ? Vec3(apart / r) : Vec3((i < j ? 1 : -1) * Vec3::UnitX());
        push[i] += 0.3 * (reach - r) * direction;
      });
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (push[i].isZero(0)) continue;
      if (dimension == 2) push[i].z() = 0;
      move(points[i], std::min(1.0, 0.25 * spacing / push[i].norm()) * push[i]);
    }
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const LayerPoint& a, const LayerPoint& b) { return a.layer < b.layer; });
  Cells kept(spacing);
  std::vector<LayerPoint> result;
  for (const LayerPoint& point : points) {
    bool free = depth_of(point.position) >= 0.2 * spacing;  // in sharp corners there is no room
    kept.visit(point.position, spacing,
               [&](std::size_t j) { free = free && (point.position - result[j].position).norm() >= 0.5 * spacing; });
    if (!free) continue;
    kept.add(point.position);
    result.push_back(point);
  }
  points = std::move(result);
}

}  // namespace embacle::coupling
