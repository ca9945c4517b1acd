#include "embacle/coupling/turnstile.hpp"

#include <exception>
#include <functional>
#include <thread>

namespace embacle::coupling {

void Turnstile::run(const std::function<void()>& first, const std::function<void()>& second) {
  turn_ = 0;
  ended_[0] = ended_[1] = false;
  failed_ = false;
  std::exception_ptr error;  // written by the side that runs, before it hands over

  const auto take_part = [&](int side, const std::function<void()>& work) {
    enter(side);
    try {
      if (!failed_) work();
    } catch (const Interrupted&) {
      // The other side has failed; its exception leaves run().
    } catch (...) {
      if (!failed_) error = std::current_exception();
      failed_ = true;
    }
    leave(side);
  };
  std::thread other(take_part, 1, std::cref(second));
  take_part(0, first);
  other.join();
  if (error) std::rethrow_exception(error);
}

void Turnstile::yield() {
  std::unique_lock lock(mutex_);
  const int me = turn_;
  const int other = 1 - me;
  if (!ended_[other]) {
    turn_ = other;
    changed_.notify_all();
    changed_.wait(lock, [&] { return turn_ == me; });
  }
  if (failed_) throw Interrupted{};
}

void Turnstile::enter(int side) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return turn_ == side; });
}

void Turnstile::leave(int side) {
  const std::scoped_lock lock(mutex_);
  ended_[side] = true;
  if (!ended_[1 - side]) turn_ = 1 - side;
  changed_.notify_all();
}

}  // namespace embacle::coupling
