// A closed surface of triangles: signed distance, and the mass properties of what it encloses.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

/// Corners [m], counterclockwise seen from outside.
using Triangle = std::array<Vec3, 3>;

/// The sign of the distance comes from the angle-weighted normal of the nearest face, edge or corner (Baerentzen &
/// Aanaes 2005, doi:10.1109/TVCG.2005.49), which is right for every closed surface. A tree of boxes keeps the
/// search short.
class ClosedSurface {
 public:
  explicit ClosedSurface(std::vector<Triangle> triangles);

  /// Distance [m] of a place to the surface, negative inside; `normal` (unless null): unit vector away from inside.
  [[nodiscard]] double distance(const Vec3& place, Vec3* normal = nullptr) const;

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  [[nodiscard]] double area() const;  ///< [m^2]
  /// The corners of triangles [m] at which faces turn by more than 30 degrees from the mean, each once.
  [[nodiscard]] const std::vector<Vec3>& sharp_corners() const { return sharp_corners_; }

 private:
  struct Face {
    Vec3 normal;
    std::array<Vec3, 3> corner_normal, edge_normal;  ///< edge k: from corner k to the next
  };
  /// Nearest point of a face, and the normal that decides the sign there.
  [[nodiscard]] Vec3 nearest(std::size_t face, const Vec3& x, const Vec3*& normal) const;
  /// A box around the faces `order_[begin]` to `order_[end - 1]`; an inner node has its two parts at the next index and
  /// at `right`.
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0, right = 0;
  };
  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  struct Nearest;
  void search(std::uint32_t node, Nearest& nearest) const;

  std::vector<Triangle> triangles_;
  std::vector<Face> faces_;
  std::vector<Vec3> sharp_corners_;
  Box bounds_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

/// Volume, centre and inertia of what triangles enclose, at unit density, by the divergence theorem: exact. The
/// integrals are sums over the tetrahedra of each triangle with one fixed place (Tonon 2005,
/// doi:10.3844/jmssp.2005.8.11).
struct SolidMoments {
  double volume = 0;            ///< [m^3]; negative if the triangles are seen clockwise from outside
  Vec3 centre = Vec3::Zero();   ///< of mass [m]
  Mat3 inertia = Mat3::Zero();  ///< about the centre, with products of inertia [m^5]
};
SolidMoments solid_moments(const std::vector<Triangle>& triangles);

/// Principal axes of a symmetric tensor as the columns of a rotation, the nearest to the given axes: cyclic Jacobi
/// rotations of at most 45 degrees. Products below 1e-12 of the trace count as zero, so that a body with equal moments
/// keeps its axes.
Mat3 principal_axes(const Mat3& tensor);

/// Divides a triangle by its longest edge until no edge is longer than `largest` [m]; visits each part with its
/// centroid and its area times normal [m^2].
void divide(const Triangle& triangle, double largest, const std::function<void(const Vec3&, const Vec3&)>& visit);

/// A problem in a file of triangles; line 0 concerns the whole file. Of a binary file, `line` is the number of a
/// triangle.
struct StlError : std::runtime_error {
  StlError(int at, const std::string& message) : std::runtime_error(message), line(at) {}
  int line;
};

/// The triangles of an STL file, ASCII or binary, turned outwards. Throws StlError unless the surface is closed: every
/// edge belongs to two triangles of the same sense.
std::vector<Triangle> parse_stl(const std::string& text);
/// Reads a file; throws InputError "file:line: ...".
std::vector<Triangle> read_stl(const std::string& path);

}  // namespace embacle::coupling
