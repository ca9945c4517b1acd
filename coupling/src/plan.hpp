// The plan of an epoch: which ranks of both sides exchange which bodies, and for how many windows that holds.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "embacle/coupling/link.hpp"
#include "transport.hpp"

namespace embacle::coupling {

/// A body as the plan of an epoch knows it; the same on every rank concerned.
struct PlannedBody {
  BodyTag tag = 0;
  int shape = 0;
  State state;                  ///< at the time of the plan
  std::vector<int> sharers;     ///< fluid ranks that its surface can come within reach of, ascending
  std::vector<int> candidates;  ///< solid ranks that can own it during the epoch, ascending
};

/// Index of the body with that tag in a list ascending in tag; nothing if it is not in the list.
std::optional<std::size_t> find(const std::vector<PlannedBody>& bodies, BodyTag tag);

/// A rank of the other side and the bodies exchanged with it.
struct Partner {
  int rank = 0;                     ///< within the other side
  int world = 0;                    ///< world rank
  std::vector<std::size_t> bodies;  ///< indices into this rank's planned bodies, ascending in tag
};

/// Partners in ascending rank order; `ranks_of` names the ranks of the other side that know a body.
std::vector<Partner> partners_of(const std::vector<PlannedBody>& bodies, std::vector<int> PlannedBody::*ranks_of,
                                 const std::vector<int>& world_ranks);

/// How far bodies may move in an epoch, and for how many windows that is enough.
struct EpochLimits {
  double margin = 0;  ///< [m]
  int windows = 0;
};

/// `speed`: bound on the speed [m/s] of every body during the epoch. The margin is a few particle distances (or the way
/// of one window, if that is longer), the number of windows what the fastest body needs to cross it, at least one.
EpochLimits limit_epoch(const Epoch& proposal, double particle_distance, double speed);

/// Bound on the speed [m/s] that this rank's bodies reach during an epoch: twice their present speed (rotation of the
/// surface included), or the fluid's reference speed.
double speed_bound(std::span<const SolidBody> owned, const SolidTerms& solid, const FluidTerms& fluid);

/// Ranks of both sides concerned with a body.
PlannedBody plan_body(const SolidBody& body, int owner, const SolidTerms& solid, double reach, double margin,
                      const std::vector<Box>& fluid_regions, const std::vector<Box>& solid_regions);

/// Solid side: sends each body to the ranks it names, and returns those that other owners send here together with this
/// rank's own, ascending in tag. Collective with `listen`. Nonblocking consensus (Hoefler, Siebert, Lumsdaine 2010,
/// doi:10.1145/1693453.1693476): synchronous sends, then a barrier entered once one's own sends have been received.
std::vector<PlannedBody> announce(const std::vector<PlannedBody>& owned, const Participants& participants, Side& side,
                                  Waiter& waiter, std::int64_t& messages_sent);

/// Fluid side: the bodies that concern this rank, ascending in tag.
std::vector<PlannedBody> listen(const Participants& participants, Side& side, Waiter& waiter);

}  // namespace embacle::coupling
