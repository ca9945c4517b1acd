// When a run is to write a checkpoint, and when it is to end before its time: signals and the wall clock.
#pragma once

#include <mpi.h>

#include <string>

#include "core/simulation.hpp"

namespace embacle::mps {

/// What a rank may ask for, in the order in which one prevails over another.
enum class Request : int { none, checkpoint, wall_limit, sigusr1, sigint, sigterm };

/// For summary.json: "end time" (none), "wall limit", "SIGTERM" ...
[[nodiscard]] std::string name_of(Request request);
/// The status with which a run ends that was asked to (see docs/failures.md).
[[nodiscard]] int status_of(Request request);
[[nodiscard]] inline bool ends_the_run(Request request) { return request > Request::checkpoint; }

/// One rank's wishes. From its construction on SIGTERM, SIGINT and SIGUSR1 no longer end the process: they are noted.
class RunControl {
 public:
  /// `wall_limit` [s] since `began` (of MPI_Wtime); 0: none.
  RunControl(const Output& output, double wall_limit, double began);

  /// What this rank asks for now.
  [[nodiscard]] Request wish() const;
  /// The largest wish of all ranks. Collective.
  [[nodiscard]] Request agree(MPI_Comm comm) const;
  /// Whether a checkpoint is due after the window that ends at `time`, or asked for.
  [[nodiscard]] bool checkpoint_due(double time, double window, Request agreed) const;
  /// Windows from `time` on until a checkpoint is due by the simulated time; at most `most`.
  [[nodiscard]] int windows_to_checkpoint(double time, double window, int most) const;
  void checkpoint_written() { last_checkpoint_ = MPI_Wtime(); }

 private:
  double every_;       ///< simulated [s]
  double wall_every_;  ///< [s]
  double limit_;       ///< of MPI_Wtime
  double last_checkpoint_;
};

}  // namespace embacle::mps
