#include "transport.hpp"

#include <fmt/format.h>

#include <limits>

namespace embacle::coupling {

void Waiter::all(std::span<MPI_Request> requests) {
  until([&] {
    int done = 0;
    MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
    return done != 0;
  });
}

int message_size(const Bytes& bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw SystemError(fmt::format("a coupling message of {} bytes is too large for MPI; use more ranks", bytes.size()));
  }
  return static_cast<int>(bytes.size());
}

bool receive_if_there(MPI_Comm comm, int source, int tag, Bytes& bytes) {
  int there = 0;
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  MPI_Improbe(source, tag, comm, &there, &message, &status);
  if (there == 0) return false;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  bytes.resize(static_cast<std::size_t>(size));
  MPI_Mrecv(bytes.data(), size, MPI_BYTE, &message, MPI_STATUS_IGNORE);  // its sender has already sent: no wait
  return true;
}

Reader receive_numbered(MPI_Comm comm, int source, int tag, std::int64_t number, Bytes& bytes, Waiter& waiter) {
  waiter.until([&] { return receive_if_there(comm, source, tag, bytes); });
  Reader in(bytes);
  if (const auto received = in.get<std::int64_t>(); received != number) {
    throw std::logic_error(fmt::format("coupling: message {} arrived where {} was expected", received, number));
  }
  return in;
}

void check_participation(const Participants& participants, const std::vector<int>& ranks, MPI_Comm own,
                         const YieldHook& yield) {
  int size = 0;
  MPI_Comm_size(own, &size);
  if (static_cast<std::size_t>(size) != ranks.size()) {
    throw std::logic_error("coupling: the link was given a communicator that is not its side's");
  }
  if (participants.shared && !yield) throw std::logic_error("coupling: the shared layout needs a yield hook");
}

Side::Side(MPI_Comm comm, Waiter& waiter) : comm_(comm), waiter_(waiter) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &size_);
}

void Side::broadcast(Bytes& bytes) {
  int size = is_root() ? message_size(bytes) : 0;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibcast(&size, 1, MPI_INT, 0, comm_, &request);
  waiter_.one(request);
  bytes.resize(static_cast<std::size_t>(size));
  MPI_Ibcast(bytes.data(), size, MPI_BYTE, 0, comm_, &request);
  waiter_.one(request);
}

std::vector<Box> Side::gather(const Box& box) {
  using Edges = std::array<double, 6>;
  const Edges mine{box.lower.x(), box.lower.y(), box.lower.z(), box.upper.x(), box.upper.y(), box.upper.z()};
  std::vector<Edges> all(static_cast<std::size_t>(size_));
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(mine.data(), 6, MPI_DOUBLE, all.data(), 6, MPI_DOUBLE, comm_, &request);
  waiter_.one(request);
  std::vector<Box> boxes;
  boxes.reserve(all.size());
  for (const Edges& e : all) boxes.push_back({Vec3(e[0], e[1], e[2]), Vec3(e[3], e[4], e[5])});
  return boxes;
}

double Side::maximum(double value) {
  double largest = value;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(&value, &largest, 1, MPI_DOUBLE, MPI_MAX, comm_, &request);
  waiter_.one(request);
  return largest;
}

bool Side::agree(std::uint64_t value) {
  const std::array<std::uint64_t, 2> mine{value, ~value};
  std::array<std::uint64_t, 2> largest{};
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(mine.data(), largest.data(), 2, MPI_UINT64_T, MPI_MAX, comm_, &request);
  waiter_.one(request);
  return largest[0] == ~largest[1];
}

Outbox::~Outbox() {
  if (completed()) return;
  static std::vector<std::vector<Bytes>> abandoned;
  abandoned.push_back(std::move(buffers_));
}

std::vector<Bytes>& Outbox::prepare(std::size_t count, Waiter& waiter) {
  waiter.until([&] { return completed(); });
  buffers_.resize(count);
  requests_.assign(count, MPI_REQUEST_NULL);
  return buffers_;
}

void Outbox::send(std::size_t index, int destination, int tag, MPI_Comm comm, bool synchronous) {
  const Bytes& bytes = buffers_[index];
  const auto send = synchronous ? MPI_Issend : MPI_Isend;
  send(bytes.data(), message_size(bytes), MPI_BYTE, destination, tag, comm, &requests_[index]);
}

bool Outbox::completed() {
  int done = 1;
  MPI_Testall(static_cast<int>(requests_.size()), requests_.data(), &done, MPI_STATUSES_IGNORE);
  return done != 0;
}

}  // namespace embacle::coupling
