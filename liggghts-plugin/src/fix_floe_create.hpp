// fix floe/create: rigid bodies placed exactly, as multispheres with the exact mass and inertia of their shape.
#pragma once

#include <vector>

#include "floe_list.hpp"
#include "floe_schedule.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

/// Creates its bodies when the script gives it, unless a restart file brought them; afterwards it only remembers their
/// shapes. Manual: docs/liggghts.
class FixFloeCreate : public LAMMPS_NS::Fix {
 public:
  FixFloeCreate(LAMMPS_NS::LAMMPS* lammps, int argc, char** argv);

  int setmask() override { return 0; }
  void post_create() override;
  void pre_delete(bool unfix) override;
  void write_restart(FILE* file) override;
  void restart(char* buffer) override;

  // What LIGGGHTS must know of bodies that are not there yet: radii of the spheres of a type, and the reach of bodies.
  double max_rad(int type) override;
  double min_rad(int type) override;
  double extend_cut_ghost() override;

  [[nodiscard]] const FloeList& list() const { return list_; }
  /// Of the bodies that appear later: see FloeTraffic.
  [[nodiscard]] FloeSchedule& schedule() { return schedule_; }
  /// Creates bodies of this fix amid a run; they must fit. Collective; a set-up must follow. Returns the last tag.
  int add(const std::vector<Floe>& floes, int last_tag);
  /// Numbers of all traffic (see FloeTraffic) that a restart file keeps; empty: none came.
  std::vector<double> traffic;

  /// Index of each covering sphere in its shape's covering, per atom.
  [[nodiscard]] LAMMPS_NS::FixPropertyAtom* sphere_index() const { return sphere_index_; }

 private:
  /// Number of the shapes of the fixes before this one.
  [[nodiscard]] int first_shape() const;

  FloeList list_;
  FloeSchedule schedule_;
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  std::string where_;
  bool restored_ = false;  ///< the bodies come from a restart file
  LAMMPS_NS::FixPropertyAtom* sphere_index_ = nullptr;
};

/// All shapes of the script's fixes floe/create, in their order: body type first_floe_type + i is element i.
std::vector<const FloeShape*> floe_shapes(LAMMPS_NS::LAMMPS* lammps);

}  // namespace embacle::liggghts
