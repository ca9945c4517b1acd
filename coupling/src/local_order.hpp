// Shared layout: the order in which the two participants of a rank work, the same on every rank.
#pragma once

namespace embacle::coupling {

/// What the two participants of one rank have done so far. Written and read by the one that holds the turn.
///
/// Between calls of its link a participant may block in collectives of its own. If one rank ran its solids while
/// another ran its water, both could block forever. So a link returns only when the other participant of its rank has
/// come to the place that the order (water of window k, solids of window k, water of window k + 1) demands.
struct LocalOrder {
  bool fluid_present = false;
  bool solid_present = false;
  bool fluid_gone = false;
  int fluid_plans = 0;   ///< plans begun by the fluid
  int solid_plans = 0;   ///< plans begun by the solids
  int fluid_loads = 0;   ///< calls of send_loads completed, the one before the first window included
  int solid_states = 0;  ///< calls of send_states completed
};

}  // namespace embacle::coupling
