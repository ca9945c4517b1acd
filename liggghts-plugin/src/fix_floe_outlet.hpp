// fix floe/outlet: a plane beyond which bodies leave a coupled run.
#pragma once

#include <string>

#include "embacle/coupling/types.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

/// Only says where bodies leave; FloeTraffic takes them away. Manual: docs/liggghts.
class FixFloeOutlet : public LAMMPS_NS::Fix {
 public:
  FixFloeOutlet(LAMMPS_NS::LAMMPS* lammps, int argc, char** argv);
  int setmask() override { return 0; }

  /// Whether a body whose centre of mass is here has left.
  [[nodiscard]] bool beyond(const coupling::Vec3& centre) const {
    return above_ ? centre[axis_] > place_ : centre[axis_] < place_;
  }

 private:
  int axis_ = 0;
  double place_ = 0;  ///< [m]
  bool above_ = true;
};

}  // namespace embacle::liggghts
