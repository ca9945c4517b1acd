// Running LIGGGHTS as the solid participant of a coupled run. No LIGGGHTS types: safe to include anywhere.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "embacle/coupling/link.hpp"

namespace embacle::liggghts {

/// What a run cost and did, for summaries. Times are wall seconds on this rank.
struct SolidReport {
  bool coupled = false;
  int ranks = 0;                      ///< ranks of the solid side
  std::int64_t bodies = 0;            ///< on all ranks, at the end
  std::int64_t covering_spheres = 0;  ///< on all ranks, at the end
  double simulated_seconds = 0;       ///< [s], in windows
  std::int64_t windows = 0;
  std::int64_t sub_steps = 0;             ///< in all windows together
  std::int64_t fewest_sub_steps = 0;      ///< in a window
  std::int64_t most_sub_steps = 0;        ///< in a window
  std::int64_t resolved_windows = 0;      ///< windows in which something could touch
  std::int64_t skin_limited_windows = 0;  ///< resolved only because the neighbour skin was too thin
  double script_seconds = 0;              ///< reading and running the script
  double step_seconds = 0;                ///< integrating the solids in windows, choice of sub-steps included
  double waiting_seconds = 0;             ///< blocked on the fluid
  double total_seconds = 0;
  coupling::LinkCounters counters;  ///< of this rank

  [[nodiscard]] double mean_sub_steps() const {
    return windows > 0 ? static_cast<double>(sub_steps) / static_cast<double>(windows) : 0.0;
  }
};

/// The report as a JSON object (of this rank).
std::string to_json(const SolidReport& report);

/// Runs LIGGGHTS with the command line `arguments` (those of `liggghts`, without the program's name: -in, -var, -log,
/// -screen, -echo ...): reads the script and runs what it says; then, if the script contains a fix couple/mps, runs the
/// coupled windows until the fluid finishes. Collective over `own`, the solid side's communicator.
///
/// `participants.world` MPI_COMM_NULL: there is no fluid; a script with a fix couple/mps is then an error.
/// With the variable `out` on the command line (-var out DIR) rank 0 writes DIR/solid-summary.json.
/// `yield` is called while waiting for the fluid (shared layout).
///
/// Returns 0. Throws RunError: InputError for an error of the script, LIGGGHTS' own included, with the script's name
/// and line. After an exception LIGGGHTS cannot be used again in this process, and its files may be incomplete.
int run_liggghts(const coupling::Participants& participants, MPI_Comm own, const std::vector<std::string>& arguments,
                 SolidReport& report, const coupling::YieldHook& yield = {});

}  // namespace embacle::liggghts
