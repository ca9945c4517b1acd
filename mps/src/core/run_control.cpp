#include "core/run_control.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <limits>

namespace embacle::mps {

namespace {

volatile std::sig_atomic_t noted = 0;

void note(int signal) {
  const Request wish = signal == SIGTERM ? Request::sigterm : signal == SIGINT ? Request::sigint : Request::sigusr1;
  if (static_cast<int>(wish) > noted) noted = static_cast<int>(wish);
}

}  // namespace

std::string name_of(Request request) {
  switch (request) {
    case Request::wall_limit:
      return "wall limit";
    case Request::sigusr1:
      return "SIGUSR1";
    case Request::sigint:
      return "SIGINT";
    case Request::sigterm:
      return "SIGTERM";
    default:
      return "end time";
  }
}

int status_of(Request request) {
  switch (request) {
    case Request::wall_limit:
    case Request::sigusr1:
      return static_cast<int>(coupling::ExitStatus::early);
    case Request::sigint:
      return 128 + SIGINT;
    case Request::sigterm:
      return 128 + SIGTERM;
    default:
      return static_cast<int>(coupling::ExitStatus::done);
  }
}

RunControl::RunControl(const Output& output, double wall_limit, double began)
    : every_(output.checkpoint_every),
      wall_every_(output.checkpoint_wall),
      limit_(wall_limit > 0 ? began + wall_limit : std::numeric_limits<double>::infinity()),
      last_checkpoint_(MPI_Wtime()) {
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1}) std::signal(signal, note);
}

Request RunControl::wish() const {
  const double now = MPI_Wtime();
  Request wish = Request::none;
  if (wall_every_ > 0 && now - last_checkpoint_ >= wall_every_) wish = Request::checkpoint;
  if (now >= limit_) wish = Request::wall_limit;
  return std::max(wish, static_cast<Request>(noted));
}

Request RunControl::agree(MPI_Comm comm) const {
  int wish_number = static_cast<int>(wish());
  MPI_Allreduce(MPI_IN_PLACE, &wish_number, 1, MPI_INT, MPI_MAX, comm);
  return static_cast<Request>(wish_number);
}

bool RunControl::checkpoint_due(double time, double window, Request agreed) const {
  if (agreed != Request::none) return true;
  const auto passed = [&](double at) { return std::floor((at + 0.5 * window) / every_); };
  return every_ > 0 && passed(time) > passed(time - window);
}

int RunControl::windows_to_checkpoint(double time, double window, int most) const {
  int count = 1;
  while (count < most && !checkpoint_due(time + count * window, window, Request::none)) ++count;
  return count;
}

}  // namespace embacle::mps
