// The bodies as the water sees them: boundary points that move with a rigid state, and the loads on them.
#pragma once

#include <span>
#include <vector>

#include "core/constants.hpp"
#include "core/decomposition.hpp"
#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "embacle/coupling/link.hpp"

namespace embacle::mps {

/// Whether this rank speaks for a body that several share, so that each counts once.
[[nodiscard]] inline bool speaks_for(int rank, const coupling::FluidBody& body) {
  return body.sharers.empty() || body.sharers.front() == rank;
}

/// The bodies within reach of this rank, during an epoch of the coupling.
class Bodies {
 public:
  Bodies(const Constants& constants, const std::vector<coupling::Shape>& shapes, int first_owner);

  /// Takes over the bodies of a new plan, or their states after a window.
  void assign(const std::vector<coupling::FluidBody>& bodies);
  [[nodiscard]] std::size_t count() const { return bodies_.size(); }

  /// Appends the body points (with place and velocity) that this rank owns.
  void collect_points(const Decomposition& decomposition, std::vector<Traveller>& points) const;
  /// Gives body points (owner `first_owner` or more) the owner that stands for their body on this rank.
  void resolve_owners(Particles& particles) const;

  /// Moves the bodies over a step with their velocities, and the own points with them.
  void drift(double step);
  void place_points(Particles& particles) const;
  /// Accelerations of the wet points for the pressure extrapolation.
  void point_accelerations(const Particles& particles, const Neighbours& neighbours,
                           std::vector<Triple>& acceleration) const;

  /// This rank's part of the load on each body from the reactions on its points.
  [[nodiscard]] std::vector<coupling::Load> partial_loads(const Particles& particles,
                                                          const std::vector<Triple>& reaction) const;
  /// Predictor: advances the velocities by a step under the whole load, gravity and the last contact force
  /// (notes on coupling, scheme P).
  void predict(std::span<const coupling::Load> total, double step);

  /// What moves a body but for the water: contact force and weight [N], and torque with the gyroscopic one [N m].
  [[nodiscard]] Eigen::Matrix<double, 6, 1> push_without_load(std::size_t body) const;
  [[nodiscard]] const coupling::MassProperties& mass(std::size_t body) const { return shape_of(bodies_[body]).mass; }
  /// Bodies of these shapes: the extrapolation takes them as not accelerated (LightBodies does that part).
  void leave_accelerations_of(const std::vector<char>& shapes) { left_out_ = shapes; }

  /// Makes way for bodies that appear, those whose tags are greater than `newer_than`: false if the water particle at
  /// this place is to be left out; otherwise moves the place so that it is not too near to a body.
  [[nodiscard]] bool make_room(double* x, std::int64_t newer_than = -1) const;
  /// Depth [m] of a place below the surface of one body (negative outside; minus the support where far away).
  [[nodiscard]] double depth_in(std::size_t body, const coupling::Vec3& place) const;
  /// Outward unit normal of the nearest face, at a place near the surface of a body.
  [[nodiscard]] coupling::Vec3 outward_normal(std::size_t body, const coupling::Vec3& place) const;
  /// Deepest position [m] of a place below the surface of any body; negative if outside all.
  [[nodiscard]] double penetration(const double* x) const;
  /// To be called when the lists are new: finds what the next two tell.
  void note_water_nearby(const Particles& particles, const Neighbours& neighbours);
  /// Own water that has points of bodies among its neighbours, ascending.
  [[nodiscard]] const std::vector<std::uint32_t>& water_nearby() const { return water_nearby_; }
  /// The bodies, ascending, that an own water particle can be near to: of which it has points among its neighbours, or
  /// all if they are few. Not those of which it is farther inside than their points lie.
  [[nodiscard]] std::span<const std::uint32_t> near(std::size_t water) const;
  /// Surface pressures of the own points of each body (for those who subscribe).
  [[nodiscard]] std::vector<coupling::BodyPressures> surface_pressures(const Particles& particles) const;

  /// Speed of the fastest point of any body, at most [m/s].
  [[nodiscard]] double fastest() const;
  struct Energy {
    double kinetic = 0, potential = 0;  ///< in gravity, zero at the origin [J]
  };
  /// Of the bodies that this rank speaks for.
  [[nodiscard]] Energy energy(int rank) const;
  /// Work [J] of all but water and gravity (contacts, tethers) on them in a window of that length [s]; `before`: the
  /// bodies at its start.
  [[nodiscard]] double work_of_contacts(const std::vector<coupling::FluidBody>& before, double length, int rank) const;

  /// Acceleration of the last window, as the extrapolation has it [m/s^2].
  [[nodiscard]] const coupling::Vec3& acceleration(std::size_t body) const { return acceleration_[body]; }
  [[nodiscard]] std::int64_t tag(std::size_t body) const { return bodies_[body].tag; }
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] const std::vector<coupling::FluidBody>& all() const { return bodies_; }
  [[nodiscard]] std::vector<coupling::Shape> shapes() const;

 private:
  struct ShapeData {
    coupling::Shape shape;
    coupling::MassProperties mass;
    std::vector<coupling::ShapePoint> points;
    double radius;
  };
  [[nodiscard]] const ShapeData& shape_of(const coupling::FluidBody& body) const { return shapes_[body.shape]; }
  [[nodiscard]] std::size_t body_of(const Identity& identity) const {
    return static_cast<std::size_t>(identity.owner - first_owner_);
  }

  const Constants& constants_;
  int first_owner_;
  coupling::Vec3 gravity_;
  std::vector<ShapeData> shapes_;
  std::vector<char> left_out_;  ///< of each shape; empty: none
  std::vector<coupling::FluidBody> bodies_;
  std::vector<coupling::Vec3> acceleration_, angular_acceleration_;  ///< of each body, for the extrapolation
  /// Of each own water particle, where its bodies begin in near_; empty if all bodies are near to all water.
  std::vector<std::uint32_t> near_begin_;
  std::vector<std::uint32_t> near_, water_nearby_;
};

}  // namespace embacle::mps
