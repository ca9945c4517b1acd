// Communication that never blocks the rank: every wait is a loop that lets the other participant of the rank run.
#pragma once

#include <mpi.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "embacle/coupling/link.hpp"
#include "wire.hpp"

namespace embacle::coupling {

/// Waits in a loop: the shared layout's hook hands over to the other participant of this rank between two tests.
class Waiter {
 public:
  explicit Waiter(YieldHook yield) : yield_(std::move(yield)) {}

  /// Returns when `done()`, which must drive the communication, gives true.
  template <typename Condition>
  void until(const Condition& done) {
    if (done()) return;
    const auto start = std::chrono::steady_clock::now();
    do {
      if (yield_) {
        yield_();
      } else {
        std::this_thread::yield();
      }
    } while (!done());
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  void all(std::span<MPI_Request> requests);
  void one(MPI_Request& request) { all({&request, 1}); }

  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  YieldHook yield_;
  double seconds_ = 0;
};

/// Number of bytes as MPI counts them; throws SystemError above 2 GiB.
int message_size(const Bytes& bytes);

/// Receives the message of that source (or MPI_ANY_SOURCE) and tag if there is one; false if not yet.
bool receive_if_there(MPI_Comm comm, int source, int tag, Bytes& bytes);

/// Collectives within one participant's private communicator.
class Side {
 public:
  Side(MPI_Comm comm, Waiter& waiter);

  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] bool is_root() const { return rank_ == 0; }

  /// The root's bytes on every rank.
  void broadcast(Bytes& bytes);
  /// The boxes of all ranks, in rank order.
  [[nodiscard]] std::vector<Box> gather(const Box& box);
  [[nodiscard]] double maximum(double value);
  /// Do all ranks pass the same number?
  [[nodiscard]] bool agree(std::uint64_t value);

 private:
  MPI_Comm comm_;
  Waiter& waiter_;
  int rank_ = 0;
  int size_ = 0;
};

/// Messages on their way: keeps each buffer until its send has completed.
class Outbox {
 public:
  Outbox() = default;
  Outbox(const Outbox&) = delete;
  Outbox& operator=(const Outbox&) = delete;
  /// Sends that cannot complete any more (the run broke) keep their buffers alive.
  ~Outbox();

  /// `count` buffers to fill; waits until the sends that used them have completed.
  std::vector<Bytes>& prepare(std::size_t count, Waiter& waiter);
  void send(std::size_t index, int destination, int tag, MPI_Comm comm, bool synchronous = false);
  /// Has every send completed (been received, if synchronous)?
  [[nodiscard]] bool completed();

 private:
  std::vector<Bytes> buffers_;
  std::vector<MPI_Request> requests_;
};

/// Receives the next message of a source, waiting for it. Window messages begin with their number since the start;
/// throws logic_error if it is not the one expected, that is, if the two sides have lost step.
Reader receive_numbered(MPI_Comm comm, int source, int tag, std::int64_t number, Bytes& bytes, Waiter& waiter);

/// Throws logic_error unless this side's own communicator has as many ranks as the list, and, in the shared layout, a
/// hook is set.
void check_participation(const Participants& participants, const std::vector<int>& ranks, MPI_Comm own,
                         const YieldHook& yield);

/// Tags of the messages on the communicator of all ranks; a rank that carries both sides tells them apart by these.
enum Tag : int {
  tag_fluid_terms = 1,
  tag_solid_terms,
  tag_proposal,
  tag_epoch,
  tag_plan_to_fluid,
  tag_plan_to_solid,
  tag_plan_done,
  tag_loads,
  tag_states,
  tag_pressures,
  tag_memory,        // to the solids of a run that continues
  tag_memory_given,  // by the solids for a checkpoint
  tag_sharers,       // on the fluid's own communicator
};

}  // namespace embacle::coupling
