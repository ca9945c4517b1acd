// Bodies that appear and leave in a coupled run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "embacle/coupling/types.hpp"
#include "fix_floe_create.hpp"
#include "fix_floe_outlet.hpp"
#include "stock.hpp"

namespace embacle::liggghts {

/// Lets the bodies of fixes floe/create enter when their time has come and their place is free, and those beyond a fix
/// floe/outlet leave; keeps the books: those at the start and those that entered are those present and those that left.
class FloeTraffic {
 public:
  /// `folder`: for floes.csv; empty: no file. `continues`: the script has taken up a restart file, made at `time` [s].
  FloeTraffic(LAMMPS_NS::LAMMPS* lammps, LAMMPS_NS::FixMultisphere* multisphere, const std::filesystem::path& folder,
              bool continues, double time);

  struct Change {
    int entered = 0;
    std::vector<coupling::BodyTag> left;
    [[nodiscard]] bool any() const { return entered > 0 || !left.empty(); }
  };
  /// To be called between two windows. If there was a change, a set-up of the run must follow. Collective.
  Change renew(double time);

 private:
  [[nodiscard]] std::vector<coupling::BodyTag> beyond_outlets() const;
  int admit(double time);
  void keep_histories();
  void write(double time) const;

  LAMMPS_NS::LAMMPS* lammps_;
  LAMMPS_NS::FixMultisphere* multisphere_;
  std::vector<FixFloeCreate*> sources_;
  std::vector<const FixFloeOutlet*> outlets_;
  std::filesystem::path file_;
  std::int64_t at_start_ = 0, entered_ = 0, left_ = 0;
  int last_tag_ = 0;
};

}  // namespace embacle::liggghts
