#include "embacle/liggghts/driver.hpp"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "coupled_run.hpp"
#include "liggghts_errors.hpp"
#include "solid_memory.hpp"
#include "stock_access.hpp"
#include "styles.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::InputError;
using coupling::RunError;

namespace {

/// The value that follows `-name` (or `-alternative`) on the command line, or empty.
std::string option_value(const std::vector<std::string>& arguments, const std::string& name,
                         const std::string& alternative) {
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
    if (arguments[i] == name || arguments[i] == alternative) return arguments[i + 1];
  }
  return "";
}

/// The value of `-var out VALUE`, or empty.
std::string output_folder(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i + 2 < arguments.size(); ++i) {
    if ((arguments[i] == "-var" || arguments[i] == "-v") && arguments[i + 1] == "out") return arguments[i + 2];
  }
  return "";
}

/// The log of the run so far stays beside that of the run that continues.
void keep_log(const std::string& log, MPI_Comm own) {
  int rank = 0;
  MPI_Comm_rank(own, &rank);
  std::error_code ignored;
  if (rank == 0 && !log.empty() && log != "none") std::filesystem::rename(log, log + ".before", ignored);
}

void write_summary(const std::string& folder, const SolidReport& report) {
  const std::string path = folder + "/solid-summary.json";
  std::ofstream file(path);
  file << to_json(report) << '\n';
  file.close();
  if (!file) throw coupling::SystemError(fmt::format("cannot write '{}'", path));
}

void report_on_screen(LAMMPS* lammps, const SolidReport& report) {
  int rank = 0;
  MPI_Comm_rank(lammps->world, &rank);
  if (rank != 0) return;
  std::string text = fmt::format(
      "Coupled run: {} windows, {:.6g} s; sub-steps per window: min {}, mean {:.4g}, max {}; {} windows resolved "
      "contacts\n",
      report.windows, report.simulated_seconds, report.fewest_sub_steps, report.mean_sub_steps(), report.most_sub_steps,
      report.resolved_windows);
  if (report.skin_limited_windows > 0) {
    text += fmt::format(
        "Coupled run: {} windows were divided only because the neighbour skin is too thin to exclude contacts; a "
        "thicker 'neighbor SKIN bin' avoids that\n",
        report.skin_limited_windows);
  }
  for (FILE* file : {lammps->screen, lammps->logfile}) {
    if (file) fmt::print(file, "{}", text);
  }
}

}  // namespace

int run_liggghts(const coupling::Participants& participants, MPI_Comm own, const std::vector<std::string>& arguments,
                 SolidReport& report, const coupling::YieldHook& yield) {
  const double start = MPI_Wtime();
  const bool fluid_present = participants.world != MPI_COMM_NULL;
  const std::string script = option_value(arguments, "-in", "-i");
  if (script.empty() && fluid_present) throw InputError("liggghts-mps: give the LIGGGHTS script with -in FILE");
  if (!option_value(arguments, "-partition", "-p").empty())
    throw InputError("liggghts-mps: -partition is not supported");

  coupling::SolidMemory memory;
  if (fluid_present) memory = coupling::receive_memory(participants, own, yield);
  const MemoryFile memory_file(memory.bytes);
  memory.bytes = {};
  std::vector<std::string> words = {"liggghts-mps"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  words.insert(words.end(), {"-var", "restarted", memory.there ? "1" : "0"});
  if (memory.there) keep_log(option_value(arguments, "-log", "-l"), own);
  for (std::size_t i = 1; i < words.size(); ++i) {
    // LIGGGHTS 3.8.0 reads meshes with a print to the screen even if there is none, and crashes.
    if ((words[i - 1] == "-screen" || words[i - 1] == "-sc") && words[i] == "none") words[i] = "/dev/null";
  }
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());

  LAMMPS* lammps = nullptr;  // not destroyed after an exception: LIGGGHTS is then in an unknown state
  FixCoupleMps* couple = nullptr;
  try {
    lammps = new LAMMPS(static_cast<int>(argv.size()), argv.data(), own);
    register_styles(lammps);
    if (memory.there) continue_from(lammps, memory_file.name());
    try {
      lammps->input->file();
    } catch (const ScriptQuit&) {
      if (fluid_present)
        throw InputError("the command quit ends the script, but a coupled run must go on with the fluid");
    }
    couple = find_couple_mps(lammps);
  } catch (const ScriptQuit&) {
    return 0;  // the command line asked for information only
  } catch (const RunError& error) {
    const std::string line = lammps ? current_script_line(lammps) : "";
    throw RunError(error.status(), fmt::format("{}: {}{}", script.empty() ? "standard input" : script, error.what(),
                                               line.empty() ? "" : fmt::format("\n  in the line: {}", line)));
  }
  if (fluid_present && !couple) {
    throw InputError(fmt::format("{}: contains no 'fix ID all couple/mps', but runs beside a fluid", script));
  }
  if (!fluid_present && couple) {
    throw InputError(
        fmt::format("{}: contains fix couple/mps, but no fluid runs beside it; run both, for example\n"
                    "  mpirun -n 1 mps SCENE : -n 1 liggghts-mps -in {}\n"
                    "or remove the fix",
                    script, script));
  }
  if (memory.there && !couple->continues()) {
    throw InputError(fmt::format(
        "{}: cannot continue from a checkpoint: its bodies were not taken up. They come with the command create_box; "
        "the "
        "fixes must follow it, fix couple/mps with the name it had, and no 'run' may stand before them, unless as "
        "if \"${{restarted}} == 0\" then \"run N\" (docs/restart.md)",
        script));
  }
  report.script_seconds = MPI_Wtime() - start;
  report.coupled = fluid_present;
  MPI_Comm_size(own, &report.ranks);
  if (fluid_present) {
    try {
      run_coupled(lammps, couple, participants, own, output_folder(arguments), yield, report);
    } catch (const RunError& error) {
      throw RunError(error.status(), fmt::format("{}: {}", script, error.what()));
    }
    report_on_screen(lammps, report);
    report.bodies = couple->multisphere()->n_body_all();
  }
  report.covering_spheres = lammps->atom->natoms;
  report.total_seconds = MPI_Wtime() - start;
  int rank = 0;
  MPI_Comm_rank(own, &rank);
  const std::string folder = output_folder(arguments);
  if (rank == 0 && fluid_present && !folder.empty()) write_summary(folder, report);
  delete lammps;
  return 0;
}

}  // namespace embacle::liggghts
