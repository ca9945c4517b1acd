// Prescribed motion of walls: where a wall stands, how fast it moves, how it accelerates.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "scene/scene.hpp"

namespace embacle::mps {

/// Displacement [m] of a wall at time t [s], linear between the rows of a table.
[[nodiscard]] Vec3d displacement(const Motion& motion, double time);

/// A quantity over time from a table, held before and after. Linear between the rows, or a cubic spline that begins and
/// ends at rest (de Boor 1978, A Practical Guide to Splines, chapter IV: complete spline with end slopes of zero),
/// whose second derivative is continuous.
class Curve {
 public:
  Curve() = default;
  Curve(const std::vector<std::pair<double, double>>& rows, Interpolation interpolation);

  [[nodiscard]] bool empty() const { return time_.empty(); }
  [[nodiscard]] double value(double time) const;
  /// First and second derivative; where they jump, those after it.
  [[nodiscard]] double rate(double time) const;
  [[nodiscard]] double acceleration(double time) const;

 private:
  /// The interval that holds a time, or size() outside of the table.
  [[nodiscard]] std::size_t interval(double time) const;

  std::vector<double> time_, value_;
  std::vector<double> second_;  ///< second derivatives at the rows; empty: linear
};

/// Where a wall is: turned about its pivot, then displaced. Walls that do not turn are only displaced.
struct Pose {
  Vec3d moved{};  ///< displacement [m]
  bool turned = false;
  Vec3d pivot{};                                       ///< at time zero [m]
  std::array<Vec3d, 3> rotation{};                     ///< rows of the matrix
  [[nodiscard]] Vec3d place(const Vec3d& zero) const;  ///< now, of what was at `zero` at time zero [m]
  [[nodiscard]] Vec3d zero(const Vec3d& place) const;  ///< the reverse
  [[nodiscard]] Vec3d turn(const Vec3d& v) const;      ///< of a direction
};

/// The motion of a wall over a step.
struct Stride {
  Pose before, after;
  double step = 0;   ///< [s]
  Vec3d velocity{};  ///< of the displacement [m/s]
  /// Mean velocity [m/s] of what was at `zero` at time zero.
  [[nodiscard]] Vec3d velocity_of(const Vec3d& zero) const;
};

/// The motion of one wall:
///   x(t) = c + d(t) + R(angle(t)) (X - c), with the pivot c and the displacement d,
/// and so, with r = x - c - d and the unit vector e of the axis, its acceleration
///   a = d'' + angle'' e x r + angle'^2 e x (e x r).
class Course {
 public:
  Course() = default;  ///< at rest
  explicit Course(const Motion& motion);

  [[nodiscard]] bool moves() const { return moves_; }
  [[nodiscard]] bool turns() const { return motion_.turns(); }
  /// Whether the water feels its acceleration: not where it moves from row to row in straight lines, which has none but
  /// at the rows.
  [[nodiscard]] bool accelerates() const { return turns() || !spline_[0].empty(); }
  [[nodiscard]] Pose pose(double time) const;
  [[nodiscard]] Stride stride(double from, double to, double step) const;
  /// [m/s^2] of the wall's material at x.
  [[nodiscard]] Vec3d acceleration(double time, const double* x) const;

 private:
  [[nodiscard]] Vec3d moved(double time) const;
  [[nodiscard]] double angle(double time) const;

  Motion motion_;
  bool moves_ = false;
  std::array<Curve, 3> spline_;  ///< of the displacement; empty: linear
  Curve angle_;
};

}  // namespace embacle::mps
