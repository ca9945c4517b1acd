// fix couple/mps: the solid side's end of the exchange with the fluid.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "contact_outlook.hpp"
#include "embacle/coupling/link.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

/// Applies the fluid's load to every body in every sub-step, reports states, and keeps the water's pressure on each
/// covering sphere. What must follow a body from rank to rank (its load, its momentum when the window began) is stored
/// as properties of the body, which LIGGGHTS migrates with it. Manual: docs/liggghts.
class FixCoupleMps : public LAMMPS_NS::Fix {
 public:
  FixCoupleMps(LAMMPS_NS::LAMMPS* lammps, int argc, char** argv);

  int setmask() override;
  void post_create() override;
  void init() override;
  void setup_pre_force(int vflag) override { pre_force(vflag); }
  void pre_force(int vflag) override;
  void write_restart(FILE* file) override;
  void restart(char* buffer) override;

  /// What the solid states at the handshake: gravity of the script's fix gravity (zero without one), box, shapes.
  [[nodiscard]] coupling::SolidTerms terms() const;
  /// Checks the bodies against the water's dimension and prepares the mapping of surface pressures, if subscribed. Call
  /// once after the handshake. Throws InputError.
  void prepare(const coupling::FluidTerms& fluid);

  /// This rank's bodies; contact force and torque are those of the last window.
  [[nodiscard]] std::vector<coupling::SolidBody> bodies() const;

  /// Takes the loads last received for the bodies of this rank, and the surface pressures with them.
  void take_loads(const coupling::SolidLink& link);
  /// Starts a window: from here on the loads taken act, and the momenta are remembered.
  void begin_window();
  /// Ends a window of length `window` [s]: mean contact force and torque are what changed the momentum beside load and
  /// gravity, (m dv)/T - load - m g.
  void end_window(double window);
  /// Asks for a rebuild of the neighbour lists in the given time step.
  void request_rebuild(bigint step) { next_reneighbor = step; }

  /// Whether the script has taken up the checkpoint from which the run continues.
  [[nodiscard]] bool continues() const { return continues_; }
  /// Throws InputError if the script has gone on from the checkpoint, or has added to it.
  void check_taken_up() const;
  /// Before the set-up of a run that continues: clock, time step, and the loads on the bodies.
  void take_up_state();
  /// After the set-up of a run that continues, and of one that has written a checkpoint: the sums of force and torque
  /// are those of the last step. The set-up makes them with velocities that are half a step younger.
  void take_up_forces();
  /// The loads on all bodies at that moment.
  [[nodiscard]] std::vector<std::pair<coupling::BodyTag, coupling::Load>> kept_loads() const;
  /// Numbers of the caller that a checkpoint keeps.
  std::vector<double> progress;

  [[nodiscard]] const SubStepRule& rule() const { return rule_; }
  [[nodiscard]] LAMMPS_NS::FixMultisphere* multisphere() const { return multisphere_; }

 private:
  using BodyVector = LAMMPS_NS::VectorContainer<double, 3>;
  BodyVector* add_body_vector(const char* name);
  [[nodiscard]] coupling::Vec3 gravity() const;  // of the script's fix gravity, zero without one [m/s^2]
  void require_unit_depth() const;
  [[nodiscard]] std::array<BodyVector*, 6> remembered() const {
    return {force_, torque_, force_before_, torque_before_, contact_force_, contact_torque_};
  }
  void take_pressures(const std::vector<coupling::BodyPressures>& all);

  std::string where_;
  SubStepRule rule_;
  int pressures_every_ = 0;
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  LAMMPS_NS::FixPropertyAtom* pressure_ = nullptr;      // [Pa] on each sphere
  LAMMPS_NS::FixPropertyAtom* sphere_index_ = nullptr;  // of each sphere in its shape's covering
  // Properties of the bodies: load in the window, load that the present force sum contains, state at its start, means.
  BodyVector *force_ = nullptr, *torque_ = nullptr;
  BodyVector *force_before_ = nullptr, *torque_before_ = nullptr;
  BodyVector *velocity_start_ = nullptr, *angular_momentum_start_ = nullptr;
  BodyVector *contact_force_ = nullptr, *contact_torque_ = nullptr;
  struct PointShare {
    int sphere;
    double area;
  };
  std::vector<std::vector<PointShare>> point_share_;  // per shape and surface point
  std::vector<std::vector<double>> sphere_area_;      // per shape and sphere: area of its points [m^2]

  /// Of the checkpoint last written or taken up, on every rank.
  struct Kept {
    double time = 0, step_length = 0;  ///< [s]
    LAMMPS_NS::bigint step = 0, atoms = 0;
    std::vector<double> bodies;  ///< per body: tag, the vectors of remembered(), sums of force and torque
  };
  Kept kept_;
  /// This rank's bodies by their number, and of each what was kept, behind the tag.
  [[nodiscard]] std::vector<std::pair<int, const double*>> kept_of_own() const;
  bool continues_ = false;
};

/// The script's fix couple/mps, or null; throws InputError if there is more than one.
FixCoupleMps* find_couple_mps(LAMMPS_NS::LAMMPS* lammps);

}  // namespace embacle::liggghts
