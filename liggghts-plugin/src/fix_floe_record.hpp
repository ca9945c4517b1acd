// fix floe/record: motion and forces of the bodies, and their energies, as CSV files.
#pragma once

#include <cstdio>
#include <string>

#include "stock.hpp"

namespace embacle::liggghts {

/// Writes a line a body, and one of energies, every so many steps; where a run continues from a restart file, what is
/// later than that is removed first. Manual: docs/liggghts.
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
  struct Table {
    std::string name;
    std::FILE* file = nullptr;  ///< on the first rank
    bool wanted = false;        ///< on all ranks
    long keep = -1;             ///< bytes that a run which continues keeps; -1: it starts
  };
  void open_tables();
  void open(Table& table, const char* head) const;
  void close_line(const Table& table) const;
  void write();
  void write_bodies();
  void write_energies();
  void write_walls();

  std::string where_;
  Table motions_, energies_, walls_;
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  LAMMPS_NS::bigint written_ = -1;
};

}  // namespace embacle::liggghts
