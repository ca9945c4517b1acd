// What the programs `mps` and `embacle-shared` do with a scene.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <string>
#include <vector>

#include "embacle/coupling/link.hpp"
#include "output/summary.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// The command line of a program that runs a scene.
struct Options {
  enum class Task { run, check, explain, launch, reference, leave };
  Task task = Task::run;
  std::filesystem::path scene;
  std::filesystem::path out = "run";
  std::vector<std::string> overrides;
  std::filesystem::path restart;  ///< the checkpoint to continue from, or its folder; empty: from the start
  double wall_limit = 0;          ///< [s]; 0: none
  int threads = 1;                ///< of each rank
  int planned_ranks = 0;          ///< for the estimates of a check; 0: as many as there are
};

/// How a run ended, on rank 0 of the water.
struct Outcome {
  Json summary;          ///< for the caller to complete and write
  int status = 0;        ///< of the program
  std::string farewell;  ///< for the terminal, after the summary is written; may be empty
};

/// Parses the command line of `program`. Task::leave: help or version was printed. Throws InputError.
[[nodiscard]] Options parse_options(int argc, char** argv, const std::string& program, const std::string& description);

/// Throws InputError if the scene is not the one of the checkpoint that it is to continue from.
void check_restart(const Scene& scene, const Options& options);

/// Counts, memory, time step and estimated run time of a scene (`--check`).
[[nodiscard]] std::string check_report(const Scene& scene, int ranks);
/// Which physics and modules a scene uses, which it leaves out, and what each costs (`--explain`).
[[nodiscard]] std::string explain_report(const Scene& scene);
/// What a launcher needs: lines `script=PATH`, `var=NAME VALUE` (`--launch`).
[[nodiscard]] std::string launch_report(const Scene& scene);

/// Runs the water of a scene to its end, or until a signal or the wall-clock limit; `participants` is null for a scene
/// without bodies. Collective over `own`.
[[nodiscard]] Outcome run_water(const Scene& scene, const Options& options, const coupling::Participants* participants,
                                MPI_Comm own, coupling::YieldHook yield = {});

/// Prints one message for the user and ends all ranks of the run with the error's status. Does not return.
[[noreturn]] void end_run(const std::string& program, const std::exception& error);

}  // namespace embacle::mps
