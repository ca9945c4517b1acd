// Bodies so light that the water's push must know how they yield to it within the step.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/bodies.hpp"
#include "core/constants.hpp"
#include "core/neighbours.hpp"
#include "embacle/coupling/link.hpp"

namespace embacle::mps {

/// The load on a light body depends on its acceleration a_b: sound carries away rho0 c0 per area of face and speed, and
/// the pressure of its points is extrapolated with rho0 a_b. Taken from the step before, either throws about a body
/// that weighs less than what it pushes; so both are solved for together with the acceleration. A point with the
/// outward normal n presses on the water by
///   dp = k (a_b.n + u),   k = 2 s rho0 c0 T + rho0 l0,   s = max(0, 1 - 1/(2 chi))
/// more than at a_b = 0, on both in opposite directions along their line, so that momentum stays exact; chi is the
/// largest eigenvalue of M^-1 Z T. With arms, matrices are 6 x 6:
///   (M + k G) a_b = F + F_contact + M g - k H,   Z = 2 rho0 c0 G,   G = (d/(rho0 n0)) m SUM r F e n^T,
/// and H likewise of u. So k G is a mass that the body carries. Where it grows, because pairs come closer, what is
/// taken up has the speed of the water: u = (v_b - v_f).n d(ln r F)/dt, zero where they part. (Without u it would have
/// the body's, and energy would come from nothing.) In the first step of a run all of it is taken up: d(ln r F) = 1.
/// T: for how long a body keeps its velocity, a step or a window. The first term of k is needed only where chi > 1/2
/// (notes on coupling, section 2); the 2 is because the pair force takes half of a point's pressure from the water. A
/// body without weight takes any motion that leaves no force on it.
///
/// Only bodies whose chi passes 1/2 when all their surface is wet are treated so; a scene without them does nothing.
class LightBodies {
 public:
  /// `horizon`: T [s] at the longest step. `shapes`: of all bodies.
  LightBodies(const Constants& constants, const std::vector<coupling::Shape>& shapes, int first_owner, double horizon);

  [[nodiscard]] bool any() const;
  /// Of each shape: whether its bodies are light.
  [[nodiscard]] const std::vector<char>& light() const { return light_; }
  /// Largest chi of the shapes, when all their surface is wet.
  [[nodiscard]] double largest_chi() const { return largest_chi_; }

  /// Adds dp to the acceleration [m/s^2] of the own water and to this rank's part of the load on each body. `horizon`:
  /// T [s] of this step; `first`: of a run. Exchanges messages between the fluid ranks that share bodies.
  void apply(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies, coupling::FluidLink& link,
             double horizon, bool first, std::vector<Triple>& acceleration, std::vector<coupling::Load>& load);

 private:
  /// A point of a light body, own or ghost.
  struct Point {
    std::size_t body;
    coupling::Vec3 arm;     ///< from the body's centre [m]
    coupling::Vec3 normal;  ///< outward
  };
  /// Own water and a point within the support.
  struct Pair {
    std::uint32_t water, point;
    Vec3d per_dp;     ///< acceleration of the water for a unit of dp
    double side;      ///< -1 behind the point: a plate of one layer has water on both sides; else 1
    double taken_up;  ///< growth of the weight in a unit of time, times the approach along the normal [m/s^2]
  };
  void gather_points(const Particles& particles, const Bodies& bodies);
  /// Finds the pairs and sums over those of each point: side times per_dp, taken_up times per_dp.
  void gather_pairs(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies, bool first);

  const Constants& constants_;
  int first_owner_;
  double largest_chi_ = 0;
  std::vector<char> light_;
  std::vector<std::vector<coupling::Vec3>> normal_;  ///< of each light shape's points, outward, in the body frame
  // Of the step, kept for their room.
  std::vector<Point> points_;
  std::vector<std::uint32_t> point_of_slot_;  ///< of each solid point, by reaction_slot()
  std::vector<std::vector<Pair>> pairs_;      ///< as each thread found them
  ThreadSums<std::array<double, 6>> sums_;    ///< of each point
  ThreadSums<Triple> pushes_;                 ///< likewise
};

}  // namespace embacle::mps
