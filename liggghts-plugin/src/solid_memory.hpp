// What LIGGGHTS needs to continue a coupled run: a restart file of its own that never touches a disk. The fluid keeps
// it in its checkpoint, so that both sides' states stand in one file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "stock.hpp"

namespace embacle::liggghts {

/// A file in memory that LIGGGHTS can open by its name.
class MemoryFile {
 public:
  explicit MemoryFile(std::span<const std::byte> content = {});
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string name() const;
  [[nodiscard]] std::vector<std::byte> content() const;

 private:
  int descriptor_;
};

/// The restart file of the present state, on rank 0. Collective. Migrates atoms and initialises everything, so that a
/// run in progress must be set up anew afterwards.
std::vector<std::byte> memory_of(LAMMPS_NS::LAMMPS* lammps);

/// From here on the command create_box of the script reads the restart file instead, which brings the box. `name`
/// matters on rank 0.
void continue_from(LAMMPS_NS::LAMMPS* lammps, const std::string& name);

}  // namespace embacle::liggghts
