#include "plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace embacle::coupling {

namespace {

/// Distance that a body may move in an epoch, in particle distances. Larger: fewer plans, more ranks in each.
constexpr double margin_in_particles = 4.0;

void write(Writer& out, const PlannedBody& body) {
  out.put(body.tag);
  out.put(body.shape);
  out.put(body.state);
  out.put(body.sharers);
  out.put(body.candidates);
}

void read_all(const Bytes& bytes, std::vector<PlannedBody>& bodies) {
  Reader in(bytes);
  while (!in.at_end()) {
    PlannedBody& body = bodies.emplace_back();
    in.get(body.tag);
    in.get(body.shape);
    in.get(body.state);
    in.get(body.sharers);
    in.get(body.candidates);
  }
}

void sort_and_check(std::vector<PlannedBody>& bodies) {
  std::sort(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.tag < b.tag; });
  const auto twice =
      std::adjacent_find(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.tag == b.tag; });
  if (twice != bodies.end()) {
    throw InstabilityError(fmt::format("body {} exists twice on the solid side", twice->tag));
  }
}

}  // namespace

std::optional<std::size_t> find(const std::vector<PlannedBody>& bodies, BodyTag tag) {
  const auto place = std::lower_bound(bodies.begin(), bodies.end(), tag,
                                      [](const PlannedBody& body, BodyTag value) { return body.tag < value; });
  if (place == bodies.end() || place->tag != tag) return std::nullopt;
  return static_cast<std::size_t>(place - bodies.begin());
}

std::vector<Partner> partners_of(const std::vector<PlannedBody>& bodies, std::vector<int> PlannedBody::*ranks_of,
                                 const std::vector<int>& world_ranks) {
  std::map<int, std::vector<std::size_t>> bodies_of;
  for (std::size_t index = 0; index < bodies.size(); ++index) {
    for (const int rank : bodies[index].*ranks_of) bodies_of[rank].push_back(index);
  }
  std::vector<Partner> partners;
  partners.reserve(bodies_of.size());
  for (auto& [rank, indices] : bodies_of) {
    partners.push_back({rank, world_ranks[static_cast<std::size_t>(rank)], std::move(indices)});
  }
  return partners;
}

EpochLimits limit_epoch(const Epoch& proposal, double particle_distance, double speed) {
  if (proposal.windows <= 0) return {};
  const double way = speed * proposal.window;
  const double margin = std::max(margin_in_particles * particle_distance, way);
  const double windows = way > 0 ? std::floor(margin / way) : proposal.windows;
  return {margin, static_cast<int>(std::clamp(windows, 1.0, static_cast<double>(proposal.windows)))};
}

double speed_bound(std::span<const SolidBody> owned, const SolidTerms& solid, const FluidTerms& fluid) {
  double bound = fluid.reference_speed;
  for (const SolidBody& body : owned) {
    const double radius = solid.shapes.at(static_cast<std::size_t>(body.shape)).bounding_radius();
    const double speed = body.state.velocity.norm() + body.state.angular_velocity.norm() * radius;
    if (!std::isfinite(speed) || !body.state.position.allFinite() || !body.state.orientation.coeffs().allFinite()) {
      throw InstabilityError(fmt::format("body {} has a state that is not a number", body.tag));
    }
    bound = std::max(bound, 2.0 * speed);
  }
  return bound;
}

PlannedBody plan_body(const SolidBody& body, int owner, const SolidTerms& solid, double reach, double margin,
                      const std::vector<Box>& fluid_regions, const std::vector<Box>& solid_regions) {
  PlannedBody planned{body.tag, body.shape, body.state, {}, {}};
  const double radius = solid.shapes[static_cast<std::size_t>(body.shape)].bounding_radius();
  const auto ranks_within = [&](const std::vector<Box>& regions, double distance, std::vector<int>& ranks, int always) {
    for (int rank = 0; rank < static_cast<int>(regions.size()); ++rank) {
      const Box& region = regions[static_cast<std::size_t>(rank)];
      if (rank == always || region.distance(body.state.position) <= distance) ranks.push_back(rank);
    }
  };
  ranks_within(fluid_regions, radius + reach + margin, planned.sharers, -1);
  ranks_within(solid_regions, margin, planned.candidates, owner);
  return planned;
}

std::vector<PlannedBody> announce(const std::vector<PlannedBody>& owned, const Participants& participants, Side& side,
                                  Waiter& waiter, std::int64_t& messages_sent) {
  std::vector<PlannedBody> known = owned;
  const std::vector<Partner> fluid = partners_of(owned, &PlannedBody::sharers, participants.fluid_ranks);
  std::vector<Partner> solid = partners_of(owned, &PlannedBody::candidates, participants.solid_ranks);
  std::erase_if(solid, [&](const Partner& partner) { return partner.rank == side.rank(); });

  Outbox outbox;
  std::vector<Bytes>& buffers = outbox.prepare(fluid.size() + solid.size(), waiter);
  std::size_t next = 0;
  const auto send_to = [&](const Partner& partner, int tag) {
    Writer out(buffers[next]);
    for (const std::size_t index : partner.bodies) write(out, owned[index]);
    outbox.send(next++, partner.world, tag, participants.world, true);
    ++messages_sent;
  };
  for (const Partner& partner : fluid) send_to(partner, tag_plan_to_fluid);
  for (const Partner& partner : solid) send_to(partner, tag_plan_to_solid);

  Bytes message;
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool all_sent = false;
  waiter.until([&] {
    while (receive_if_there(participants.world, MPI_ANY_SOURCE, tag_plan_to_solid, message)) read_all(message, known);
    if (!all_sent) {
      all_sent = outbox.completed();
      if (all_sent) MPI_Ibarrier(side.comm(), &barrier);
      return false;
    }
    int done = 0;
    MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
    return done != 0;
  });
  if (side.is_root()) {
    outbox.prepare(1, waiter);
    outbox.send(0, participants.fluid_ranks.front(), tag_plan_done, participants.world);
    waiter.until([&] { return outbox.completed(); });
  }
  sort_and_check(known);
  return known;
}

std::vector<PlannedBody> listen(const Participants& participants, Side& side, Waiter& waiter) {
  std::vector<PlannedBody> known;
  Bytes message;
  // The solid root says when all plans have been received; the fluid root passes it on.
  bool announced = !side.is_root();
  int nothing = 0;
  MPI_Request done_everywhere = MPI_REQUEST_NULL;
  if (announced) MPI_Ibcast(&nothing, 1, MPI_INT, 0, side.comm(), &done_everywhere);
  waiter.until([&] {
    while (receive_if_there(participants.world, MPI_ANY_SOURCE, tag_plan_to_fluid, message)) read_all(message, known);
    if (!announced) {
      announced = receive_if_there(participants.world, participants.solid_ranks.front(), tag_plan_done, message);
      if (announced) MPI_Ibcast(&nothing, 1, MPI_INT, 0, side.comm(), &done_everywhere);
      return false;
    }
    int done = 0;
    MPI_Test(&done_everywhere, &done, MPI_STATUS_IGNORE);
    return done != 0;
  });
  sort_and_check(known);
  return known;
}

}  // namespace embacle::coupling
