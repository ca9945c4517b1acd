// The fluid's end of the exchange.
#include <fmt/format.h>

#include <algorithm>

#include "embacle/coupling/link.hpp"
#include "handshake.hpp"
#include "local_order.hpp"
#include "plan.hpp"
#include "transport.hpp"

namespace embacle::coupling {

namespace {

/// A fluid rank that shares bodies with this one; both list them in the same order.
struct Neighbour {
  int rank = 0;
  std::vector<std::size_t> bodies;
  std::vector<double> theirs;  ///< their part of a sum, body by body
};

}  // namespace

struct FluidLink::Impl {
  Impl(Participants p, const FluidTerms& t, YieldHook yield)
      : participants(std::move(p)), terms(t), waiter(std::move(yield)), side(participants.fluid_side, waiter) {}

  void plan_neighbours();
  void take_state(Reader& in, std::vector<int>& arrived);
  void note_missing(std::size_t index);
  /// Shared layout: waits until the solid of this rank is where the common order wants it.
  template <typename Condition>
  void keep_order(const Condition& reached) {
    if (participants.order) waiter.until([&] { return reached(*participants.order); });
  }

  Participants participants;
  FluidTerms terms;
  SolidTerms solid;
  Waiter waiter;
  Waiter inner_waiter{{}};  // among fluid ranks: never hands over, or the two sides' order would differ between ranks
  Side side;

  std::vector<PlannedBody> planned;  // ascending in tag, parallel to `bodies`
  std::vector<FluidBody> bodies;
  std::vector<Partner> partners;
  std::vector<Neighbour> neighbours;
  double margin = 0;
  double window = 0;
  std::int64_t loads_sent = 0;
  std::int64_t states_received = 0;
  Outbox load_messages;
  Outbox pressure_messages;
  Outbox sharer_messages;
  Outbox memory_message;
  Bytes inbox;
  mutable LinkCounters counters;
};

FluidLink::FluidLink(const Participants& participants, MPI_Comm own, const FluidTerms& terms, YieldHook yield,
                     std::span<const std::byte> memory) {
  if (participants.solid_ranks.empty()) {
    throw InputError(
        "the scene has solids but no solid program takes part; start one in the same mpirun "
        "(mpirun -n 4 mps scene.toml : -n 2 liggghts-mps -in in.floes)");
  }
  check_participation(participants, participants.fluid_ranks, own, yield);
  impl_ = std::make_unique<Impl>(participants, terms, std::move(yield));
  Impl& m = *impl_;
  if (m.participants.order) m.participants.order->fluid_present = true;
  if (m.side.is_root()) {  // the solids wait for it before they state their terms
    m.memory_message.prepare(1, m.waiter).front().assign(memory.begin(), memory.end());
    m.memory_message.send(0, m.participants.solid_ranks.front(), tag_memory, m.participants.world);
  }
  m.solid = shake_hands(terms, m.participants, m.side, m.waiter);
  m.keep_order([](const LocalOrder& order) { return order.solid_present; });
}

FluidLink::~FluidLink() {
  if (impl_ && impl_->participants.order) impl_->participants.order->fluid_gone = true;
}

FluidLink::FluidLink(FluidLink&&) noexcept = default;

const SolidTerms& FluidLink::solid() const { return impl_->solid; }

Epoch FluidLink::plan(const Box& region, const Epoch& proposal) {
  Impl& m = *impl_;
  if (m.participants.order) ++m.participants.order->fluid_plans;
  const std::vector<Box> regions = m.side.gather(region);

  Outbox outbox;
  Bytes limits;
  if (m.side.is_root()) {
    Writer out(outbox.prepare(1, m.waiter).front());
    out.put(proposal.windows);
    out.put(proposal.window);
    out.put(proposal.time);
    out.put(proposal.checkpoint);
    out.put(regions);
    const int solid_root = m.participants.solid_ranks.front();
    outbox.send(0, solid_root, tag_proposal, m.participants.world);
    m.waiter.until([&] { return receive_if_there(m.participants.world, solid_root, tag_epoch, limits); });
    m.waiter.until([&] { return outbox.completed(); });
  }
  m.side.broadcast(limits);
  Reader in(limits);
  Epoch epoch = proposal;
  in.get(epoch.windows);
  in.get(m.margin);
  m.window = epoch.window;

  m.planned = epoch.windows > 0 ? listen(m.participants, m.side, m.waiter) : std::vector<PlannedBody>{};
  m.partners = partners_of(m.planned, &PlannedBody::candidates, m.participants.solid_ranks);
  m.bodies.clear();
  for (const PlannedBody& body : m.planned)
    m.bodies.push_back({body.tag, body.shape, body.state, {}, body.sharers, false});
  m.plan_neighbours();
  if (epoch.windows == 0 && !epoch.checkpoint && m.participants.order) m.participants.order->fluid_gone = true;
  return epoch;
}

std::vector<std::byte> FluidLink::checkpoint(const Box& region, double time) {
  Impl& m = *impl_;
  plan(region, {0, 0, time, true});
  Bytes memory, done;
  if (m.side.is_root()) {
    const int solid_root = m.participants.solid_ranks.front();
    m.waiter.until([&] { return receive_if_there(m.participants.world, solid_root, tag_memory_given, memory); });
  }
  m.side.broadcast(done);  // all ranks wait for that
  m.keep_order([](const LocalOrder& order) { return order.solid_plans > order.fluid_plans; });
  return memory;
}

void FluidLink::Impl::plan_neighbours() {
  neighbours.clear();
  for (Partner& partner : partners_of(planned, &PlannedBody::sharers, participants.fluid_ranks)) {
    if (partner.rank == side.rank()) continue;
    neighbours.push_back({partner.rank, std::move(partner.bodies), {}});
  }
}

const std::vector<FluidBody>& FluidLink::bodies() const { return impl_->bodies; }

double FluidLink::margin() const { return impl_->margin; }

bool FluidLink::surface_pressures_due() const {
  const int every = impl_->solid.surface_pressure_every;
  return every > 0 && (loads_before(impl_->terms) + impl_->loads_sent) % every == 0;
}

void FluidLink::send_loads(std::span<const Load> partial, std::span<const BodyPressures> pressures) {
  Impl& m = *impl_;
  if (partial.size() != m.bodies.size()) throw std::logic_error("coupling: send_loads needs one load per body");
  if (!pressures.empty() && !surface_pressures_due()) {
    throw std::logic_error("coupling: surface pressures were given in a window in which none are due");
  }
  std::vector<Bytes>& messages = m.load_messages.prepare(m.partners.size(), m.waiter);
  for (std::size_t i = 0; i < m.partners.size(); ++i) {
    Writer out(messages[i]);
    out.put(m.loads_sent);
    for (const std::size_t index : m.partners[i].bodies) {
      out.put(m.bodies[index].tag);
      out.put(partial[index]);
    }
    m.load_messages.send(i, m.partners[i].world, tag_loads, m.participants.world);
    ++m.counters.messages_sent;
    m.counters.bytes_sent += static_cast<std::int64_t>(messages[i].size());
  }
  if (surface_pressures_due()) {
    std::vector<const BodyPressures*> by_index(m.bodies.size(), nullptr);
    for (const BodyPressures& part : pressures) {
      const std::optional<std::size_t> index = find(m.planned, part.tag);
      if (!index) throw std::logic_error(fmt::format("coupling: surface pressures of the unknown body {}", part.tag));
      by_index[*index] = &part;
    }
    std::vector<Bytes>& parts = m.pressure_messages.prepare(m.partners.size(), m.waiter);
    for (std::size_t i = 0; i < m.partners.size(); ++i) {
      Writer out(parts[i]);
      out.put(m.loads_sent);
      for (const std::size_t index : m.partners[i].bodies) {
        if (by_index[index] == nullptr) continue;
        out.put(by_index[index]->tag);
        out.put(by_index[index]->point);
        out.put(by_index[index]->pressure);
      }
      m.pressure_messages.send(i, m.partners[i].world, tag_pressures, m.participants.world);
      ++m.counters.messages_sent;
      m.counters.bytes_sent += static_cast<std::int64_t>(parts[i].size());
    }
  }
  ++m.loads_sent;
  if (m.participants.order) ++m.participants.order->fluid_loads;
}

void FluidLink::receive_states() {
  Impl& m = *impl_;
  std::vector<int> arrived(m.bodies.size(), 0);
  for (const Partner& partner : m.partners) {
    Reader in = receive_numbered(m.participants.world, partner.world, tag_states, m.states_received, m.inbox, m.waiter);
    while (!in.at_end()) m.take_state(in, arrived);
  }
  for (std::size_t index = 0; index < arrived.size(); ++index) {
    if (arrived[index] == 0) m.note_missing(index);
  }
  ++m.states_received;
  ++m.counters.windows;
  m.keep_order([&](const LocalOrder& order) { return order.solid_states >= m.states_received; });
}

void FluidLink::Impl::take_state(Reader& in, std::vector<int>& arrived) {
  const auto tag = in.get<BodyTag>();
  const std::optional<std::size_t> index = find(planned, tag);
  if (!index) throw std::logic_error(fmt::format("coupling: a state of the unplanned body {}", tag));
  if (++arrived[*index] > 1) throw InstabilityError(fmt::format("body {} has two owners on the solid side", tag));
  FluidBody& body = bodies[*index];
  in.get(body.state);
  in.get(body.applied);
  body.vanished = false;
}

/// No solid rank of the plan owns the body any more: it was deleted, or, if it was about to leave the margin, it was
/// lost.
void FluidLink::Impl::note_missing(std::size_t index) {
  FluidBody& body = bodies[index];
  if (!body.vanished) {
    const double moved = (body.state.position - planned[index].state.position).norm();
    const double speed = body.state.velocity.norm();
    if (moved + 2.0 * speed * window > margin) {
      throw InstabilityError(fmt::format(
          "body {} was lost: it had moved {:.4g} m since the last plan, which allows {:.4g} m, at {:.4g} m/s", body.tag,
          moved, margin, speed));
    }
  }
  body.vanished = true;
  body.state.velocity.setZero();
  body.state.angular_velocity.setZero();
  body.state.contact_force.setZero();
  body.state.contact_torque.setZero();
  body.applied = {};
}

void FluidLink::sum_over_sharers(std::span<double> partial, std::size_t numbers) {
  Impl& m = *impl_;
  if (partial.size() != numbers * m.bodies.size()) {
    throw std::logic_error("coupling: sum_over_sharers needs its numbers for every body");
  }
  const MPI_Comm comm = m.side.comm();
  std::vector<Bytes>& mine = m.sharer_messages.prepare(m.neighbours.size(), m.inner_waiter);
  std::vector<MPI_Request> requests(m.neighbours.size(), MPI_REQUEST_NULL);
  for (std::size_t i = 0; i < m.neighbours.size(); ++i) {
    Neighbour& neighbour = m.neighbours[i];
    neighbour.theirs.resize(numbers * neighbour.bodies.size());
    MPI_Irecv(neighbour.theirs.data(), static_cast<int>(neighbour.theirs.size()), MPI_DOUBLE, neighbour.rank,
              tag_sharers, comm, &requests[i]);
    Writer out(mine[i]);
    for (const std::size_t index : neighbour.bodies) {
      for (std::size_t n = 0; n < numbers; ++n) out.put(partial[numbers * index + n]);
    }
    m.sharer_messages.send(i, neighbour.rank, tag_sharers, comm);
    ++m.counters.predictor_messages_sent;
  }
  m.inner_waiter.all(requests);

  // In ascending rank order, this rank in its place.
  const std::vector<double> own(partial.begin(), partial.end());
  std::ranges::fill(partial, 0.0);
  bool added_own = false;
  const auto add_own = [&] {
    for (std::size_t k = 0; k < own.size(); ++k) partial[k] += own[k];
    added_own = true;
  };
  for (const Neighbour& neighbour : m.neighbours) {
    if (!added_own && neighbour.rank > m.side.rank()) add_own();
    const double* theirs = neighbour.theirs.data();
    for (const std::size_t index : neighbour.bodies) {
      for (std::size_t n = 0; n < numbers; ++n) partial[numbers * index + n] += *theirs++;
    }
  }
  if (!added_own) add_own();
}

void FluidLink::sum_over_sharers(std::span<Load> partial) {
  std::vector<double> numbers;
  for (const Load& load : partial) {
    numbers.insert(numbers.end(), load.force.begin(), load.force.end());
    numbers.insert(numbers.end(), load.torque.begin(), load.torque.end());
  }
  sum_over_sharers(numbers, 6);
  for (std::size_t b = 0; b < partial.size(); ++b) {
    const double* sums = numbers.data() + 6 * b;
    partial[b] = {Vec3(sums[0], sums[1], sums[2]), Vec3(sums[3], sums[4], sums[5])};
  }
}

const LinkCounters& FluidLink::counters() const {
  impl_->counters.waiting_seconds = impl_->waiter.seconds();
  return impl_->counters;
}

}  // namespace embacle::coupling
