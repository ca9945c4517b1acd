// The first exchange: each side states its terms, both check that they fit.
#pragma once

#include "embacle/coupling/link.hpp"
#include "transport.hpp"

namespace embacle::coupling {

/// Sends this side's terms to the other side and returns the other's. Collective over all ranks of both sides.
/// Throws InputError on every rank of both sides if the terms do not fit, with all reasons.
SolidTerms shake_hands(const FluidTerms& mine, const Participants& participants, Side& side, Waiter& waiter);
FluidTerms shake_hands(const SolidTerms& mine, const Participants& participants, Side& side, Waiter& waiter);

/// Messages with loads before the checkpoint from which a run continues: the parallel scheme began with one more.
inline std::int64_t loads_before(const FluidTerms& terms) {
  return terms.windows_before + (terms.windows_before > 0 && terms.scheme == Scheme::parallel ? 1 : 0);
}

}  // namespace embacle::coupling
