// The solid's end of the exchange.
#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "embacle/coupling/link.hpp"
#include "handshake.hpp"
#include "local_order.hpp"
#include "plan.hpp"
#include "transport.hpp"

namespace embacle::coupling {

struct SolidLink::Impl {
  Impl(Participants p, const SolidTerms& t, YieldHook yield)
      : participants(std::move(p)), terms(t), waiter(std::move(yield)), side(participants.solid_side, waiter) {}

  void receive_pressures();
  void keep_loads_of_known_bodies(std::span<const SolidBody> owned);
  void check_within_margin(const SolidBody& body, const PlannedBody& plan) const;
  /// Shared layout: waits until the fluid of this rank is where the common order wants it.
  template <typename Condition>
  void keep_order(const Condition& reached) {
    if (participants.order)
      waiter.until([&] { return participants.order->fluid_gone || reached(*participants.order); });
  }

  Participants participants;
  SolidTerms terms;
  FluidTerms fluid;
  Waiter waiter;
  Side side;

  std::vector<PlannedBody> planned;  // bodies that can be owned here during the epoch, ascending in tag
  std::vector<Partner> partners;
  std::unordered_map<BodyTag, Load> loads;
  std::vector<BodyPressures> pressures;
  double margin = 0;
  double window = 0;
  int windows_since_plan = 0;
  int plans = 0;
  bool owes_memory = false;
  std::int64_t loads_received = 0;
  std::int64_t states_sent = 0;
  Outbox state_messages;
  Outbox memory_message;
  Bytes inbox;
  mutable LinkCounters counters;
};

SolidLink::SolidLink(const Participants& participants, MPI_Comm own, const SolidTerms& terms, YieldHook yield) {
  check_participation(participants, participants.solid_ranks, own, yield);
  impl_ = std::make_unique<Impl>(participants, terms, std::move(yield));
  Impl& m = *impl_;
  if (m.participants.order) m.participants.order->solid_present = true;
  m.fluid = shake_hands(terms, m.participants, m.side, m.waiter);
  // The memory comes before the terms: still here if the program did not ask for it.
  Bytes memory;
  if (m.side.is_root() &&
      receive_if_there(m.participants.world, m.participants.fluid_ranks.front(), tag_memory, memory) &&
      !memory.empty()) {
    throw InputError("the water continues from a checkpoint, but this program of the solids cannot");
  }
  m.keep_order([](const LocalOrder& order) { return order.fluid_plans > 0; });
}

SolidLink::~SolidLink() = default;
SolidLink::SolidLink(SolidLink&&) noexcept = default;

const FluidTerms& SolidLink::fluid() const { return impl_->fluid; }

SolidMemory receive_memory(const Participants& participants, MPI_Comm own, const YieldHook& yield) {
  check_participation(participants, participants.solid_ranks, own, yield);
  Waiter waiter(yield);
  Side side(participants.solid_side, waiter);
  SolidMemory memory;
  if (side.is_root()) {
    const int fluid_root = participants.fluid_ranks.front();
    waiter.until([&] { return receive_if_there(participants.world, fluid_root, tag_memory, memory.bytes); });
  }
  memory.there = side.maximum(memory.bytes.empty() ? 0 : 1) > 0;
  return memory;
}

void SolidLink::give_memory(std::span<const std::byte> memory) {
  Impl& m = *impl_;
  if (!m.owes_memory) throw std::logic_error("coupling: give_memory belongs after a plan with checkpoint");
  m.owes_memory = false;
  if (!m.side.is_root()) return;
  m.memory_message.prepare(1, m.waiter).front().assign(memory.begin(), memory.end());
  m.memory_message.send(0, m.participants.fluid_ranks.front(), tag_memory_given, m.participants.world);
}

void SolidLink::take_up_loads(std::span<const std::pair<BodyTag, Load>> loads) {
  for (const auto& [tag, load] : loads) impl_->loads[tag] = load;
}

Epoch SolidLink::plan(const Box& region, std::span<const SolidBody> owned) {
  Impl& m = *impl_;
  if (m.owes_memory) throw std::logic_error("coupling: a plan with checkpoint calls for give_memory");
  if (m.participants.order) ++m.participants.order->solid_plans;
  const int fluid_root = m.participants.fluid_ranks.front();
  Bytes message;
  if (m.side.is_root()) {
    m.waiter.until([&] { return receive_if_there(m.participants.world, fluid_root, tag_proposal, message); });
  }
  m.side.broadcast(message);
  Reader in(message);
  Epoch epoch;
  in.get(epoch.windows);
  in.get(epoch.window);
  in.get(epoch.time);
  in.get(epoch.checkpoint);
  const auto fluid_regions = in.get<std::vector<Box>>();

  const std::vector<Box> solid_regions = m.side.gather(region);
  const EpochLimits limits =
      limit_epoch(epoch, m.fluid.particle_distance, m.side.maximum(speed_bound(owned, m.terms, m.fluid)));
  epoch.windows = limits.windows;
  m.margin = limits.margin;
  m.window = epoch.window;
  m.windows_since_plan = 0;
  if (m.side.is_root()) {
    Outbox outbox;
    Writer out(outbox.prepare(1, m.waiter).front());
    out.put(limits.windows);
    out.put(limits.margin);
    outbox.send(0, fluid_root, tag_epoch, m.participants.world);
    m.waiter.until([&] { return outbox.completed(); });
  }

  m.planned.clear();
  if (epoch.windows > 0) {
    std::vector<PlannedBody> mine;
    mine.reserve(owned.size());
    for (const SolidBody& body : owned) {
      mine.push_back(plan_body(body, m.side.rank(), m.terms, m.fluid.reach, m.margin, fluid_regions, solid_regions));
    }
    m.planned = announce(mine, m.participants, m.side, m.waiter, m.counters.plan_messages_sent);
  }
  m.partners = partners_of(m.planned, &PlannedBody::sharers, m.participants.fluid_ranks);
  m.keep_loads_of_known_bodies(owned);
  ++m.plans;
  m.owes_memory = epoch.checkpoint;
  if (epoch.checkpoint) return epoch;  // the water waits until this side plans again
  m.keep_order([&](const LocalOrder& order) { return epoch.windows > 0 && order.fluid_loads > m.loads_received; });
  return epoch;
}

/// The parallel scheme begins an epoch with the last loads of the one before, perhaps on another rank.
void SolidLink::Impl::keep_loads_of_known_bodies(std::span<const SolidBody> owned) {
  std::unordered_map<BodyTag, Load> kept;
  const auto keep = [&](BodyTag tag) {
    if (const auto entry = loads.find(tag); entry != loads.end()) kept.insert(*entry);
  };
  for (const PlannedBody& body : planned) keep(body.tag);
  for (const SolidBody& body : owned) keep(body.tag);
  loads = std::move(kept);
}

void SolidLink::receive_loads() {
  Impl& m = *impl_;
  m.loads.clear();
  for (const Partner& partner : m.partners) {  // ascending in rank: the sum does not depend on who came first
    Reader in = receive_numbered(m.participants.world, partner.world, tag_loads, m.loads_received, m.inbox, m.waiter);
    while (!in.at_end()) {
      const auto tag = in.get<BodyTag>();
      m.loads[tag] += in.get<Load>();
    }
  }
  m.receive_pressures();
  ++m.loads_received;
  m.keep_order([&](const LocalOrder& order) {
    // Serial: the water of this window is done. Parallel: so is that of the next, unless a plan comes first.
    if (m.fluid.scheme == Scheme::serial) return order.fluid_loads >= m.loads_received;
    return order.fluid_loads > m.loads_received || order.fluid_plans > m.plans;
  });
}

void SolidLink::Impl::receive_pressures() {
  pressures.clear();
  const int every = terms.surface_pressure_every;
  if (every == 0 || (loads_before(fluid) + loads_received) % every != 0) return;
  std::unordered_map<BodyTag, std::size_t> place;
  for (const Partner& partner : partners) {
    Reader in = receive_numbered(participants.world, partner.world, tag_pressures, loads_received, inbox, waiter);
    while (!in.at_end()) {
      const auto tag = in.get<BodyTag>();
      const auto [entry, is_new] = place.try_emplace(tag, pressures.size());
      if (is_new) pressures.push_back({tag, {}, {}});
      BodyPressures& body = pressures[entry->second];
      const auto points = in.get<std::vector<int>>();
      const auto values = in.get<std::vector<double>>();
      body.point.insert(body.point.end(), points.begin(), points.end());
      body.pressure.insert(body.pressure.end(), values.begin(), values.end());
    }
  }
}

Load SolidLink::load(BodyTag tag) const {
  const auto entry = impl_->loads.find(tag);
  return entry != impl_->loads.end() ? entry->second : Load{};
}

const std::vector<BodyPressures>& SolidLink::surface_pressures() const { return impl_->pressures; }

void SolidLink::Impl::check_within_margin(const SolidBody& body, const PlannedBody& plan) const {
  if (!body.state.position.allFinite() || !body.state.velocity.allFinite()) {
    throw InstabilityError(fmt::format("body {} has a state that is not a number", body.tag));
  }
  const double moved = (body.state.position - plan.state.position).norm();
  if (moved <= margin * (1 + 1e-9)) return;
  throw InstabilityError(fmt::format(
      "body {} moved {:.4g} m within {} windows of {:.4g} s, more than the {:.4g} m that a plan allows; its speed is "
      "{:.4g} "
      "m/s. The reference speed of the water ({:.4g} m/s) is too low, or the contacts are unstable",
      body.tag, moved, windows_since_plan, window, margin, body.state.velocity.norm(), fluid.reference_speed));
}

void SolidLink::send_states(std::span<const SolidBody> owned) {
  Impl& m = *impl_;
  ++m.windows_since_plan;
  std::vector<const SolidBody*> owned_here(m.planned.size(), nullptr);
  for (const SolidBody& body : owned) {
    const std::optional<std::size_t> index = find(m.planned, body.tag);
    if (!index) continue;  // inserted since the plan
    m.check_within_margin(body, m.planned[*index]);
    owned_here[*index] = &body;
  }
  std::vector<Bytes>& messages = m.state_messages.prepare(m.partners.size(), m.waiter);
  for (std::size_t i = 0; i < m.partners.size(); ++i) {
    Writer out(messages[i]);
    out.put(m.states_sent);
    for (const std::size_t index : m.partners[i].bodies) {
      const SolidBody* body = owned_here[index];
      if (body == nullptr) continue;
      out.put(body->tag);
      out.put(body->state);
      out.put(load(body->tag));
    }
    m.state_messages.send(i, m.partners[i].world, tag_states, m.participants.world);
    ++m.counters.messages_sent;
    m.counters.bytes_sent += static_cast<std::int64_t>(messages[i].size());
  }
  ++m.states_sent;
  ++m.counters.windows;
  if (m.participants.order) ++m.participants.order->solid_states;
}

const LinkCounters& SolidLink::counters() const {
  impl_->counters.waiting_seconds = impl_->waiter.seconds();
  return impl_->counters;
}

}  // namespace embacle::coupling
