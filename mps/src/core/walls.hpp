// Walls: prescribed motion, the points that represent them, and thin walls that water sees from one side only.
#pragma once

#include <array>
#include <vector>

#include "core/motion.hpp"
#include "core/particles.hpp"
#include "core/periodic.hpp"
#include "core/solid.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// Sides of a wall point, stored in Identity::point. Points of thick walls are `both`. A wall thinner than the support
/// gets, for each of its two sides, its own layers completed by extra layers behind, which only water on that side
/// sees: a gate of one layer then holds water as a thick wall does, and the two waters do not feel each other through
/// it.
enum WallSide : std::int32_t { both = 0, plus = 1, minus = -1, plus_extra = 2, minus_extra = -2 };

/// A thin wall at its present place.
struct ThinWall {
  int axis = 0;
  std::array<double, 3> lower{}, upper{};
  [[nodiscard]] double middle() const { return 0.5 * (lower[axis] + upper[axis]); }
};

/// The walls of a scene in motion.
class Walls {
 public:
  Walls(const Scene& scene, int dimension, int layers);

  [[nodiscard]] int count() const { return static_cast<int>(walls_.size()); }
  [[nodiscard]] const Course& course(int wall) const { return courses_[wall]; }
  [[nodiscard]] bool any_moves() const { return any_moves_; }
  /// Whether the water feels the acceleration of any (see Course).
  [[nodiscard]] bool any_accelerates() const { return any_accelerates_; }
  /// Strides of all walls (see Course).
  [[nodiscard]] std::vector<Stride> strides(double from, double to, double step) const;
  /// Farthest way [m] of a point of any wall, wet or dry, between its places at two times.
  [[nodiscard]] double travel(double from, double to) const;
  /// Thin walls where they stand at `time`.
  [[nodiscard]] std::vector<ThinWall> thin_walls(double time) const;
  /// Whether water at x may interact with a point of `side` of wall `wall` (thin[wall] from thin_walls()).
  [[nodiscard]] static bool visible(const ThinWall& wall, std::int32_t side, const double* x);
  /// Whether the straight line between two places passes through the wall.
  [[nodiscard]] static bool separates(const ThinWall& wall, const double* a, const double* b, int dimension);

  /// Points of wall `wall` at time zero: position and side, in a fixed order.
  struct Point {
    std::array<double, 3> x;
    std::int32_t side;
  };
  [[nodiscard]] std::vector<Point> points(int wall) const;
  /// Distances [m] of a point of a wall and of water from the wall's surface, both along its normal there.
  struct Distances {
    double point, water;
  };
  /// `pose`: of the wall now; `side`: of the point (see WallSide). Both places may be images.
  [[nodiscard]] Distances distances(int wall, std::int32_t side, const Pose& pose, const double* point,
                                    const double* water, const Periodic& periodic) const;
  /// Index into thin_walls() of each wall, or -1.
  [[nodiscard]] int thin_index(int wall) const { return thin_index_[wall]; }
  [[nodiscard]] const Wall& definition(int wall) const { return walls_[wall]; }
  /// The solid of a wall that is neither tank nor box, where it stands at time zero; else null.
  [[nodiscard]] const Solid* solid(int wall) const { return solids_[wall] ? &*solids_[wall] : nullptr; }

 private:
  [[nodiscard]] std::vector<Point> tank_points(const Wall& wall) const;
  [[nodiscard]] std::vector<Point> box_points(const Wall& wall) const;

  std::vector<Wall> walls_;
  std::vector<Course> courses_;               ///< of each wall
  std::vector<std::optional<Solid>> solids_;  ///< of each wall
  std::vector<int> thin_index_;
  std::vector<int> thin_axis_;
  int dimension_;
  int layers_;
  double particle_distance_;
  bool any_moves_ = false;
  bool any_accelerates_ = false;
};

/// Centres of the cells of a lattice of about `spacing` that fits between lower and upper exactly.
[[nodiscard]] std::vector<double> fitted_lattice(double lower, double upper, double spacing);

}  // namespace embacle::mps
