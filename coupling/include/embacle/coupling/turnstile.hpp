// Shared layout: two participants on one rank take turns, so that neither needs the other's ranks.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>

namespace embacle::coupling {

/// Runs two bodies of code on two threads of which exactly one runs at any moment (a baton). A side hands over only
/// when it waits for the coupling, through yield(), so MPI_THREAD_SERIALIZED is enough and the order of execution is
/// deterministic. If a side throws, the exception leaves run() after the other side was released with `Interrupted`.
class Turnstile {
 public:
  struct Interrupted {};  ///< thrown out of yield() on the other side when one side has failed

  /// Runs `first` and `second` to their ends; `first` starts. Rethrows the first exception of either side.
  void run(const std::function<void()>& first, const std::function<void()>& second);
  /// Called by the running side: lets the other side run until it yields in turn (or has ended).
  void yield();

 private:
  void enter(int side);
  void leave(int side);
  std::mutex mutex_;
  std::condition_variable changed_;
  int turn_ = 0;
  bool ended_[2] = {false, false};
  bool failed_ = false;
};

}  // namespace embacle::coupling
