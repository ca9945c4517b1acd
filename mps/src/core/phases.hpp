// Wall time by phase of the step.
#pragma once

#include <mpi.h>

#include <array>

namespace embacle::mps {

enum class Phase {
  search,
  halo,
  corrections,
  continuity,
  walls,
  forces,
  integration,
  bodies,
  coupling,
  output,
  synchronisation,
  count
};

inline constexpr std::array<const char*, static_cast<std::size_t>(Phase::count)> phase_names = {
    "search",      "halo",   "corrections", "continuity", "walls",          "forces",
    "integration", "bodies", "coupling",    "output",     "synchronisation"};

class Phases {
 public:
  /// Adds the time of its own life to a phase.
  class Timer {
   public:
    Timer(Phases& phases, Phase phase) : phases_(phases), phase_(phase), start_(MPI_Wtime()) {}
    ~Timer() { phases_.seconds_[static_cast<std::size_t>(phase_)] += MPI_Wtime() - start_; }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

   private:
    Phases& phases_;
    Phase phase_;
    double start_;
  };
  /// Adds time that was spent before this run.
  void add(std::size_t phase, double seconds) { seconds_[phase] += seconds; }
  [[nodiscard]] double seconds(Phase phase) const { return seconds_[static_cast<std::size_t>(phase)]; }
  [[nodiscard]] const auto& all() const { return seconds_; }

 private:
  std::array<double, static_cast<std::size_t>(Phase::count)> seconds_{};
};

}  // namespace embacle::mps
