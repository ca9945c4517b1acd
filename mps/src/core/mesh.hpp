// Signed distance to a closed surface of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace embacle::mps {

/// The sign comes from the angle-weighted normal of the nearest face, edge or corner (Baerentzen & Aanaes 2005,
/// doi:10.1109/TVCG.2005.49), which is right for every closed surface. Cells of triangles keep the search local.
class Mesh {
 public:
  explicit Mesh(const std::vector<Triangle>& triangles);

  /// Distance [m] of a place to the surface, negative inside; `normal` (unless null): unit vector away from inside.
  [[nodiscard]] double distance(const double* x, Vec3d* normal) const;

 private:
  struct Face {
    std::array<Vec3d, 3> corner;
    Vec3d normal;
    std::array<Vec3d, 3> corner_normal, edge_normal;  ///< edge k: from corner k to the next
  };
  /// Nearest point of a face, and the normal that decides the sign there.
  static Vec3d nearest(const Face& face, const Vec3d& x, const Vec3d*& normal);
  [[nodiscard]] int cell_along(int axis, double x) const;

  std::vector<Face> faces_;
  Vec3d lower_{};
  std::array<int, 3> cells_{1, 1, 1};
  double cell_ = 1;  ///< edge [m]
  std::vector<std::uint32_t> first_, listed_;
};

}  // namespace embacle::mps
