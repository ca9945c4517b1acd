// Threads of a rank: loops shared out among them.
#pragma once

#include <array>
#include <cstddef>
#include <exception>
#include <vector>

#include "core/room.hpp"

namespace embacle::mps {

/// Most threads a rank may have.
inline constexpr int most_threads = 64;
/// Threads that share the loops of this rank; 1 until set.
[[nodiscard]] int threads();
void set_threads(int count);
/// First of the items of `part`, of `n` items shared out evenly in order.
[[nodiscard]] inline std::size_t first_of_part(std::size_t n, int part) {
  return n * static_cast<std::size_t>(part) / static_cast<std::size_t>(threads());
}

/// Calls body(thread) once in every thread. An exception is passed on: that of the lowest thread.
template <class Body>
void in_every_thread(const Body& body) {
  if (threads() == 1) {
    body(0);
    return;
  }
  std::array<std::exception_ptr, most_threads> thrown{};
#pragma omp parallel for schedule(static, 1) num_threads(threads())
  for (int thread = 0; thread < threads(); ++thread) {
    try {
      body(thread);
    } catch (...) {
      thrown[thread] = std::current_exception();
    }
  }
  for (const std::exception_ptr& error : thrown) {
    if (error) std::rethrow_exception(error);
  }
}

/// Calls body(first, last, thread) in every thread, with its part of [0, n).
template <class Body>
void in_parallel(std::size_t n, const Body& body) {
  in_every_thread([&](int thread) { body(first_of_part(n, thread), first_of_part(n, thread + 1), thread); });
}

/// Calls body(k, thread) for every k below n, shared out as above.
template <class Body>
void for_each(std::size_t n, const Body& body) {
  in_parallel(n, [&](std::size_t first, std::size_t last, int thread) {
    for (std::size_t k = first; k < last; ++k) body(k, thread);
  });
}

/// Sums to which any thread adds anywhere: each has its own, joined in the order of the threads.
template <class Value>
class ThreadSums {
 public:
  /// `n` sums of zero.
  void reset(std::size_t n) {
    make_room(total_, n);
    total_.assign(n, Value{});
    others_.resize(static_cast<std::size_t>(threads()) - 1);
    for (auto& part : others_) resize(part, n);  // all zero but for what is new: see join()
  }
  [[nodiscard]] Value* of_thread(int thread) { return thread == 0 ? total_.data() : others_[thread - 1].data(); }
  /// Adds up what all threads have added so far.
  void join() {
    if (others_.empty()) return;
    in_parallel(total_.size(), [&](std::size_t first, std::size_t last, int) {
      for (auto& part : others_) {
        for (std::size_t k = first; k < last; ++k) {
          add(total_[k], part[k]);
          part[k] = Value{};
        }
      }
    });
  }
  [[nodiscard]] const std::vector<Value>& total() const { return total_; }
  [[nodiscard]] std::vector<Value>& total() { return total_; }
  [[nodiscard]] std::size_t bytes() const { return total_.capacity() * sizeof(Value) * (1 + others_.size()); }

 private:
  template <std::size_t N>
  static void add(std::array<double, N>& to, const std::array<double, N>& from) {
    for (std::size_t c = 0; c < N; ++c) to[c] += from[c];
  }
  template <class Sum>
  static void add(Sum& to, const Sum& from) {
    to += from;
  }
  std::vector<Value> total_;
  std::vector<std::vector<Value>> others_;
};

}  // namespace embacle::mps
