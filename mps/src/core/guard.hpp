// Keeps water out of solids where the particle forces alone would let it seep in.
#pragma once

#include <vector>

#include "core/bodies.hpp"
#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "core/walls.hpp"

namespace embacle::mps {

/// Water closer to a solid's true surface than a fraction of its spacing loses the normal velocity with which it
/// approaches, and is pushed out by a spring. In water at rest particles keep about half a spacing, so nothing happens
/// there; it acts in splashes and in gaps narrower than a particle, where the pressure extrapolated to one solid says
/// nothing of the other. Whatever else acts on a particle, its next step must end outside the solids; where it is
/// squeezed between a body and a wall, the wall has the last word. What a solid overran leaves it at a bounded speed.
/// The force on a body is the exact opposite of that on the water.
class Guard {
 public:
  Guard(const Scene& scene, const Constants& constants, const Walls& walls);

  /// To be called when the own water has been put into another order: it has so many particles.
  void forget(std::size_t water) { seen_.assign(solids_.size() * water, Seen{}); }
  /// Adds to the acceleration of the own water, sets `wall_loads` to the opposite forces (one per wall; torques about
  /// the origin), and adds those on bodies to `body_loads` (one per body of this rank; ignored without bodies). `time`
  /// is that of the positions.
  void apply(const Particles& particles, const Neighbours& neighbours, const Bodies* bodies, double time, double step,
             std::vector<Triple>& acceleration, std::vector<coupling::Load>& wall_loads,
             std::vector<coupling::Load>& body_loads);
  /// Energy [J] that the springs hold at the places of the last `apply`, of the own water.
  [[nodiscard]] double stored_energy() const { return stored_.total().empty() ? 0 : stored_.total()[0]; }

 private:
  /// Acceleration magnitude along the outward normal for a place `distance` outside the surface (negative: inside),
  /// with normal velocity `approach` relative to it (negative: approaching).
  [[nodiscard]] double push(double distance, double approach) const;

  struct Contact {
    int solid;  ///< a wall, or the number of walls + a body
    Vec3d normal;
    double distance;
    double approach;  ///< normal velocity relative to the surface, negative: approaching
    double push;      ///< acceleration along the normal
  };
  /// Adds the pushes to the acceleration and enlarges them until the next step ends outside all solids.
  void hold_outside(std::vector<Contact>& contacts, Triple& acceleration, double step) const;

  /// Where the distance to a solid was last measured: what has moved by less than that lacks to the guarded distance
  /// need not be measured again.
  struct Seen {
    Vec3d place{};  ///< at the wall's zero pose
    double distance = -1e300;
  };
  struct Face {  ///< of a tank: the water is on the side of increasing sign * x[axis]
    int wall;
    int axis;
    double sign;
    double place;
  };
  const Constants& constants_;
  const Walls& walls_;
  std::vector<int> solids_;  ///< walls that are neither tank nor box
  std::vector<Seen> seen_;   ///< of each own water particle, of each of those
  std::vector<Face> faces_;
  std::vector<int> boxes_;
  const Scene& scene_;
  double distance_;                   ///< within which it acts
  double clearance_;                  ///< that the next step leaves
  double leaving_speed_;              ///< outward, above which it does not push [m/s]
  double stiffness_;                  ///< [1/s^2]
  ThreadSums<coupling::Load> loads_;  ///< on each wall, then on each body
  ThreadSums<double> stored_;         ///< energy of the springs [J]
};

}  // namespace embacle::mps
