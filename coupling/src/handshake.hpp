// The first exchange: each side states its terms, both check that they fit.
#pragma once

#include "embacle/coupling/link.hpp"
#include "transport.hpp"

namespace embacle::coupling {

/// Sends this side's terms to the other side and returns the other's. Collective over all ranks of both sides.
/// Throws InputError on every rank of both sides if the terms do not fit, with all reasons.
SolidTerms shake_hands(const FluidTerms& mine, const Participants& participants, Side& side, Waiter& waiter);
FluidTerms shake_hands(const SolidTerms& mine, const Participants& participants, Side& side, Waiter& waiter);

}  // namespace embacle::coupling
