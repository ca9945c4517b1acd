// fix floe/record: motion and forces of the bodies as a CSV file.
#pragma once

#include <cstdio>
#include <string>

#include "stock.hpp"

namespace embacle::liggghts {

/// Writes a line a body every so many steps; where a run continues from a restart file, what is later than that is
/// removed first. Manual: docs/liggghts.
class FixFloeRecord : public LAMMPS_NS::Fix {
 public:
  FixFloeRecord(LAMMPS_NS::LAMMPS* lammps, int argc, char** argv);
  ~FixFloeRecord() override;

  int setmask() override;
  void post_create() override;
  void setup(int vflag) override;
  void end_of_step() override;
  void write_restart(std::FILE* file) override;
  void restart(char* buffer) override;

 private:
  void write();
  void open();

  std::string where_, file_name_;
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  std::FILE* file_ = nullptr;  ///< on the first rank
  LAMMPS_NS::bigint written_ = -1;
  long keep_ = -1;  ///< bytes of the file that a run which continues keeps; -1: it starts
};

}  // namespace embacle::liggghts
