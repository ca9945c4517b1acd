// What can touch within the next window, and the sub-step that resolves it.
#pragma once

#include <cstdint>

#include "stock.hpp"

namespace embacle::liggghts {

/// Options of the choice.
struct SubStepRule {
  double resolution = 100;      ///< sub-steps per Hertz contact time
  double minimum_speed = 0.01;  ///< lower bound [m/s] of the approach speed in the contact time
};

/// The choice for one window.
struct SubSteps {
  int count = 1;
  bool skin_limited = false;  ///< resolved only because the neighbour list's skin is too thin to exclude a contact
};

/// Duration [s] of a Hertz contact of spheres, 2.87 (m*^2 / (R* E*^2 v))^(1/5) (Timoshenko & Goodier, Theory of
/// Elasticity, 3rd ed., section 142), with effective mass [kg], radius [m], modulus [Pa] and approach speed [m/s];
/// `contacts` equal contacts at once act as one of stiffness `contacts` E*.
double hertz_contact_time(double mass, double radius, double modulus, double speed, int contacts);

/// Chooses sub-steps window by window. One sub-step if nothing can touch: for every pair of the neighbour list, every
/// sphere and primitive wall, and every listed sphere and mesh triangle, the gap exceeds the largest relative motion
/// within the window (present relative speed and the largest acceleration, bounded over all bodies); pairs outside the
/// list are at least the unused rest of the skin apart. Otherwise the window is divided into sub-steps of at most
/// contact time / resolution, the contact time being the shortest among the pairs that can touch. Pairs and walls of
/// model floe are judged by FloeContacts::outlook instead.
class ContactOutlook {
 public:
  ContactOutlook(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere, SubStepRule rule);

  /// The sub-steps of the next window of length `window` [s]. Collective over the solid ranks.
  SubSteps choose(double window);
  /// Whether the neighbour lists should be rebuilt at the end of this window, so that the next can be judged by them.
  [[nodiscard]] bool rebuild_advisable() const { return rebuild_advisable_; }
  /// To be called after the window was integrated.
  void window_done(double window);

 private:
  struct Nearest;  // what the scans below collect
  double largest_acceleration() const;
  double largest_displacement() const;
  double mesh_speed() const;
  void scan_pairs(Nearest& nearest) const;
  void scan_primitive_walls(Nearest& nearest) const;
  void scan_meshes(Nearest& nearest, double speed) const;

  LAMMPS_NS::LAMMPS* lammps_;
  LAMMPS_NS::FixMultisphere* multisphere_;
  SubStepRule rule_;
  double modulus_ = 0;      // effective modulus [Pa] of the stiffest pair; 0: no material
  double mesh_travel_ = 0;  // bound [m] of the meshes' motion since the last neighbour build
  double mesh_speed_now_ = 0;
  std::int64_t builds_ = 0;
  bool first_ = true;
  bool rebuild_advisable_ = false;
};

}  // namespace embacle::liggghts
