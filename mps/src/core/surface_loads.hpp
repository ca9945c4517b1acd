// Loads on bodies from the pressure on their surface, as an alternative to the reaction of the pair forces.
#pragma once

#include <vector>

#include "core/bodies.hpp"
#include "core/constants.hpp"
#include "core/particles.hpp"

namespace embacle::mps {

/// `coupling.loads = "pressure"`: F = -SUM p A n over the surface points (thesis eq 5.40), with the true areas of the
/// shape in place of l0^(d-1). A point at an edge or corner stands for one piece of each face. The points lie half a
/// layer below the surface: p is carried to it by rho0 (g - a_b).r, as it was extrapolated to them. Friction is not in
/// it, and the water does not feel the opposite force: momentum is not conserved. A body of one layer of points has no
/// normals between its opposite faces, and feels nothing there.
class SurfaceLoads {
 public:
  SurfaceLoads(const Constants& constants, const Bodies& bodies, int first_owner);

  /// This rank's part of the load on each body: of its own points.
  [[nodiscard]] std::vector<coupling::Load> partial_loads(const Particles& particles, const Bodies& bodies) const;

 private:
  /// Piece of the surface that belongs to a point, in the body frame.
  struct Piece {
    coupling::Vec3 place;  ///< on the surface [m]
    coupling::Vec3 area;   ///< times outward normal [m^2]
  };
  struct ShapePieces {
    std::vector<Piece> pieces;
    std::vector<std::size_t> first;  ///< of each point; one more than points
  };

  const Constants& constants_;
  int first_owner_;
  double thickness_;  ///< of the slice in 2-D, else 1 [m]
  std::vector<ShapePieces> shapes_;
};

}  // namespace embacle::mps
