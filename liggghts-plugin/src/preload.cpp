// Gives the styles to a stock `liggghts` that runs with LD_PRELOAD=libembacle-liggghts.so, for runs without water.
// It stands before LIGGGHTS' own Input::file(), which the program calls once, before it reads the first line.
#include <dlfcn.h>

#include <cstdlib>

#include "embacle/coupling/types.hpp"
#include "fix_couple_mps.hpp"
#include "stock_access.hpp"
#include "styles.hpp"

namespace LAMMPS_NS {

__attribute__((visibility("default"))) void Input::file() {
  using Original = void (*)(Input*);
  static const auto original = reinterpret_cast<Original>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS5Input4fileEv"));
  embacle::liggghts::register_styles(lmp);
  try {
    original(this);
    if (embacle::liggghts::find_couple_mps(lmp)) {
      throw embacle::coupling::InputError("the script contains fix couple/mps: run it with liggghts-mps beside mps");
    }
  } catch (const embacle::coupling::RunError& failure) {
    // All ranks read the same script and meet the same error.
    const std::string script_line = embacle::liggghts::current_script_line(lmp);
    if (me == 0) {
      for (FILE* file : {logfile, stderr}) {
        if (file) std::fprintf(file, "ERROR: %s\n  in the line: %s\n", failure.what(), script_line.c_str());
      }
    }
    if (logfile) std::fclose(logfile);
    MPI_Finalize();
    std::exit(static_cast<int>(failure.status()));
  }
}

}  // namespace LAMMPS_NS
