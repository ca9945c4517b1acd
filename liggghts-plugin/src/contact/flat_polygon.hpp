// A convex polygon in a plane, cut by half-spaces. No LIGGGHTS here.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "embacle/coupling/shape.hpp"

namespace embacle::liggghts {

/// The half-space normal . x <= offset; the normal is a unit vector only where that is said.
struct HalfSpace {
  coupling::Vec3 normal;
  double offset;  ///< [m], with a unit normal

  /// Whether it holds a whole box, or nothing of it.
  [[nodiscard]] bool holds(const coupling::Vec3& centre, const coupling::Vec3& half) const {
    return normal.dot(centre) + normal.cwiseAbs().dot(half) <= offset;
  }
  [[nodiscard]] bool misses(const coupling::Vec3& centre, const coupling::Vec3& half) const {
    return normal.dot(centre) - normal.cwiseAbs().dot(half) > offset;
  }
};

/// A convex polygon in a plane (Sutherland & Hodgman 1974, doi:10.1145/360767.360802), kept as its projection along the
/// axis that is nearest to the normal: a place is origin + s along + t across.
class FlatPolygon {
 public:
  struct Corner {
    double s, t;
  };
  /// What a half-space holds of the plane: a s + b t <= c.
  struct HalfPlane {
    double a, b, c;
  };

  /// The part in a box of the plane normal . x = offset, with a unit normal; false if there is none.
  bool set(const coupling::Vec3& normal, double offset, const coupling::Vec3& lower, const coupling::Vec3& upper);
  /// Likewise, but of the box's faces across the axis nearest to the normal those that cut are only added to `cuts`.
  bool set(const coupling::Vec3& normal, double offset, const coupling::Vec3& lower, const coupling::Vec3& upper,
           std::vector<HalfPlane>& cuts);
  /// A triangle in the plane.
  void set(const coupling::Vec3& normal, double offset, const coupling::Triangle& triangle);
  /// Adds what those of some half-spaces hold that cut the box of set(); false if one of them holds nothing there.
  bool gather(std::span<const HalfSpace> half_spaces, std::vector<HalfPlane>& cuts) const;
  /// Keeps what lies in the half-plane or half-space, or in all half-planes; false if nothing is left.
  bool cut(const HalfPlane& half_plane);
  bool cut(const HalfSpace& half_space) { return cut(trace(half_space)); }
  bool cut(const std::vector<HalfPlane>& half_planes) {
    return std::ranges::all_of(half_planes, [this](const HalfPlane& half_plane) { return cut(half_plane); });
  }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const Corner& corner(std::size_t c) const { return corners_[c]; }
  [[nodiscard]] coupling::Vec3 origin() const { return level_ * coupling::Vec3::Unit(main_); }
  [[nodiscard]] coupling::Vec3 along() const {
    return coupling::Vec3::Unit(first_) - slope_[0] * coupling::Vec3::Unit(main_);
  }
  [[nodiscard]] coupling::Vec3 across() const {
    return coupling::Vec3::Unit(second_) - slope_[1] * coupling::Vec3::Unit(main_);
  }
  [[nodiscard]] coupling::Vec3 place(const Corner& corner) const {
    return origin() + corner.s * along() + corner.t * across();
  }
  /// Area [m^2] of the triangle of the corners 0, c - 1 and c.
  [[nodiscard]] double area(std::size_t c) const;
  /// Area [m^2] of the whole.
  [[nodiscard]] double area() const;

 private:
  void lay(const coupling::Vec3& normal, double offset);
  [[nodiscard]] HalfPlane trace(const HalfSpace& half_space) const {
    const double steep = half_space.normal[main_];
    return {half_space.normal[first_] - steep * slope_[0], half_space.normal[second_] - steep * slope_[1],
            half_space.offset - steep * level_};
  }

  int main_ = 2, first_ = 0, second_ = 1;  ///< axes
  std::array<double, 2> slope_{};          ///< along the main axis x = level - slope[0] s - slope[1] t
  double level_ = 0;
  double stretch_ = 1;        ///< area over that of the projection
  Corner middle_{}, half_{};  ///< of the box's projection, and half its edges
  std::size_t count_ = 0;
  std::vector<Corner> corners_ = std::vector<Corner>(16), spare_ = std::vector<Corner>(16);
};

}  // namespace embacle::liggghts
