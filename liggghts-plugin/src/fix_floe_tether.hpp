// fix floe/tether: a line or rod from a place of a body to a fixed place in space.
#pragma once

#include <string>

#include "embacle/coupling/types.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

/// Adds the force of a spring and damper between two places to a body. Keeps no state. Manual: docs/liggghts.
class FixFloeTether : public LAMMPS_NS::Fix {
 public:
  FixFloeTether(LAMMPS_NS::LAMMPS* lammps, int argc, char** argv);

  int setmask() override;
  void post_create() override;
  void init() override;
  void setup(int vflag) override { post_force(vflag); }
  void post_force(int vflag) override;
  /// Tension [N] of the last step, negative in a rod that pushes. Collective.
  double compute_scalar() override;

 private:
  /// Index of the body among those of this rank; -1: another rank has it, or none.
  [[nodiscard]] int find_body() const;

  std::string where_;
  int tag_ = 0;
  coupling::Vec3 place_ = coupling::Vec3::Zero();   ///< on the body, relative to its centre, in its axes [m]
  coupling::Vec3 anchor_ = coupling::Vec3::Zero();  ///< [m]
  bool pushes_ = false;                             ///< a rod
  double length_ = 0;                               ///< [m]
  double stiffness_ = 0;                            ///< [N/m]
  double damping_ = 0;                              ///< [N s/m]
  double tension_ = 0;                              ///< [N], on the rank that has the body
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
};

}  // namespace embacle::liggghts
