// A convex polygon in a plane, cut by half-spaces. No LIGGGHTS here.
#pragma once

#include <array>
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

  /// The part in a box of the plane normal . x = offset, with a unit normal; false if there is none.
  bool set(const coupling::Vec3& normal, double offset, const coupling::Vec3& lower, const coupling::Vec3& upper);
  /// A triangle in the plane.
  void set(const coupling::Vec3& normal, double offset, const coupling::Triangle& triangle);
  /// Keeps what lies in the half-space; false if nothing is left.
  bool cut(const HalfSpace& half_space);

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

  int main_ = 2, first_ = 0, second_ = 1;  ///< axes
  std::array<double, 2> slope_{};          ///< along the main axis x = level - slope[0] s - slope[1] t
  double level_ = 0;
  double stretch_ = 1;  ///< area over that of the projection
  std::size_t count_ = 0;
  std::vector<Corner> corners_ = std::vector<Corner>(16), spare_;
  std::vector<double> above_;  ///< how far each corner was beyond the half-space of the last cut
};

}  // namespace embacle::liggghts
