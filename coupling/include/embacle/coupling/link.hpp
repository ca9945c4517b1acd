// The exchange between the two participants of a coupled run: one small public interface.
//
// Legal order of calls (fluid on the left, solid on the right; "=" marks calls that all ranks of both sides make
// together, "->" and "<-" are point-to-point messages between the ranks of the plan only):
//
//                                       receive_memory(...)         what the solids gave in a checkpoint, if any
//     FluidLink(...)                 =  SolidLink(...)              handshake: units, gravity, shapes, terms
//     while not finished:
//       plan(region, ...)            =  plan(region, bodies)        one epoch: who talks to whom, for how many windows
//       for each window of the epoch:
//         (advance the water)           serial:   receive_loads, (advance the solids), send_states
//         send_loads                 -> parallel: (advance the solids), send_states, receive_loads
//         receive_states             <-
//
// Instead of a plan the fluid may ask for a checkpoint; both sides then plan again:
//
//       checkpoint(region, time)     =  plan(region, bodies)        gives an epoch without windows, `checkpoint` set
//                                       give_memory(...)            all that the solids need to continue from here
//
// The fluid keeps that memory in its own checkpoint and gives it back, through its FluidLink, to the solids of a run
// that continues from there. So there is one file, of one moment of both sides.
//
// A rank without partners in the epoch sends and receives nothing. In the parallel scheme both sides compute at the
// same time and the solid uses the loads of the window before (zero-th: the load at the start, sent by send_loads
// before the first window: see `FluidTerms::scheme`). That first pair, send_loads and receive_loads directly after the
// first plan, comes once in a run; later epochs of the parallel scheme, and runs that continue, start with the last
// loads of the epoch before.
//
// Bodies: a body is planned at the fluid ranks that its surface can reach and at the solid ranks to which it can
// migrate within the epoch; regions must not change within an epoch. A body inserted within an epoch is unknown to the
// fluid until the next plan. A body deleted within an epoch stays at rest for the fluid, marked `vanished`, until the
// next plan.
//
// Shared layout: both participants of a rank call this interface from the two threads of a Turnstile. Every rank then
// works in the same order, water of window 1, solids of window 1, water of window 2, ..., and control changes only
// inside calls of the links. So blocking collectives of either side, between calls of its link, cannot block the other
// side's.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "embacle/coupling/shape.hpp"
#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

inline constexpr int protocol_version = 3;

enum class Role : int { fluid = 0, solid = 1 };
enum class Scheme : int { serial = 0, parallel = 1 };

/// Both programs of `mpirun A : B` call this once, first: splits MPI_COMM_WORLD by role.
/// In the shared layout every rank holds both roles and passes `layout_shared`.
struct Participants {
  MPI_Comm world = MPI_COMM_NULL;            ///< all ranks of both sides (a private duplicate)
  MPI_Comm fluid_side = MPI_COMM_NULL;       ///< the fluid ranks, private to FluidLink; null on other ranks
  MPI_Comm solid_side = MPI_COMM_NULL;       ///< the solid ranks, private to SolidLink; null on other ranks
  std::vector<int> fluid_ranks;              ///< world ranks that carry a piece of the fluid, in fluid-rank order
  std::vector<int> solid_ranks;              ///< likewise for the solid
  bool shared = false;                       ///< every rank carries both sides
  std::shared_ptr<struct LocalOrder> order;  ///< shared layout: who of this rank's two participants may go on
};

/// Separate ranks: `role` is this program's. Collective over MPI_COMM_WORLD. `own` receives this side's communicator.
/// Throws InputError if the other side is absent (and `role` is solid) or shows another protocol version.
Participants split_world(Role role, MPI_Comm& own);
/// Shared ranks: every rank carries both; two private duplicates of MPI_COMM_WORLD.
Participants share_world(MPI_Comm& fluid, MPI_Comm& solid);
/// Frees the private communicators after the links are gone. Collective over all ranks of both sides.
void release(Participants& participants);

/// What the fluid states at the handshake and the solid must accept.
struct FluidTerms {
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]
  int dimension = 3;
  Scheme scheme = Scheme::serial;
  double particle_distance = 0;     ///< l0 [m]: spacing of the points at which surface pressures are given
  double point_depth = 0;           ///< depth [m] of body points that the fluid uses
  double reach = 0;                 ///< distance [m] from a body's surface within which a fluid rank must know it
  double reference_speed = 0;       ///< largest speed expected [m/s]; bounds how far a body moves in an epoch
  double fluid_density = 0;         ///< [kg/m^3]
  std::int64_t windows_before = 0;  ///< done before the checkpoint from which the run continues
};

/// What the solid states at the handshake and the fluid must accept.
struct SolidTerms {
  Vec3 gravity = Vec3::Zero();  ///< [m/s^2]; compared with the fluid's
  std::string units = "si";
  Box domain;                      ///< the solid side's simulation box [m]
  int surface_pressure_every = 0;  ///< windows between surface-pressure messages; 0: not subscribed
  std::vector<Shape> shapes;       ///< all shapes that can appear during the run (the same on every solid rank)
};

/// Terms of an epoch, agreed by `plan`.
struct Epoch {
  int windows = 0;          ///< number of windows until the next plan; 0: the run is finished, unless `checkpoint`
  double window = 0;        ///< length of each window [s]
  double time = 0;          ///< time at the start of the epoch [s]
  bool checkpoint = false;  ///< the solids give what they need to continue from here, then plan again
};

/// Counted since the start, on this rank.
struct LinkCounters {
  std::int64_t windows = 0;
  std::int64_t messages_sent = 0;  ///< window messages (loads, states, surface pressures); not plans
  std::int64_t bytes_sent = 0;
  std::int64_t plan_messages_sent = 0;
  std::int64_t predictor_messages_sent = 0;  ///< partial loads between fluid ranks that share a body
  double waiting_seconds = 0;                ///< wall time blocked on the other side
};

/// A body as a fluid rank knows it during an epoch.
struct FluidBody {
  BodyTag tag = 0;
  int shape = 0;             ///< index into SolidTerms::shapes
  State state;               ///< at the end of the last received window
  Load applied;              ///< load that the solid side applied in its last window (summed over fluid ranks)
  std::vector<int> sharers;  ///< fluid ranks (fluid communicator) that know this body, ascending, self included
  bool vanished = false;     ///< the solid side deleted it within the epoch: stays at rest until the next plan
};

struct BodyPressures {
  BodyTag tag = 0;
  std::vector<int> point;        ///< indices into Shape::points(...)
  std::vector<double> pressure;  ///< [Pa]
};

/// A wait that lets the other participant of the same rank run; set by the shared layout (see turnstile.hpp).
using YieldHook = std::function<void()>;

class FluidLink {
 public:
  /// Handshake; collective over all ranks of both sides. Throws InputError on a mismatch, on every rank, naming both.
  /// `memory`: what checkpoint() returned, on rank 0, if the run continues from there.
  FluidLink(const Participants& participants, MPI_Comm own, const FluidTerms& terms, YieldHook yield = {},
            std::span<const std::byte> memory = {});
  ~FluidLink();
  FluidLink(FluidLink&&) noexcept;

  [[nodiscard]] const SolidTerms& solid() const;

  /// New plan; collective over all ranks of both sides. `region`: this rank's subdomain. `proposal`: windows the fluid
  /// would like (0: finish), the window's length and time; the solid side may shorten `windows` so that no body moves
  /// farther than the margin. Afterwards bodies() holds the bodies within reach of `region`.
  Epoch plan(const Box& region, const Epoch& proposal);

  /// Between epochs: what the solids need to continue from this moment, on rank 0 (elsewhere nothing). The next call is
  /// plan or checkpoint. Collective over all ranks of both sides.
  [[nodiscard]] std::vector<std::byte> checkpoint(const Box& region, double time);

  [[nodiscard]] const std::vector<FluidBody>& bodies() const;
  /// Largest distance [m] that a body may move during the epoch (plans include it).
  [[nodiscard]] double margin() const;

  /// This rank's part of the mean load over the window, one per bodies() entry; surface pressures if due.
  void send_loads(std::span<const Load> partial, std::span<const BodyPressures> pressures = {});
  [[nodiscard]] bool surface_pressures_due() const;
  /// Completes the window: updates the state of each of bodies().
  void receive_states();

  /// Sums `numbers` values of each of bodies() over the fluid ranks that share it, in rank order (bitwise the same on
  /// all of them).
  void sum_over_sharers(std::span<double> partial, std::size_t numbers);
  /// Likewise partial loads, one per body.
  void sum_over_sharers(std::span<Load> partial);

  [[nodiscard]] const LinkCounters& counters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A body as its owner on the solid side gives it.
struct SolidBody {
  BodyTag tag = 0;
  int shape = 0;
  State state;
};

/// What the solids gave in the checkpoint from which the run continues.
struct SolidMemory {
  bool there = false;            ///< the run continues; known on all ranks
  std::vector<std::byte> bytes;  ///< on rank 0 of the solids
};
/// The solid side calls this once, before its SolidLink. Collective over the solids.
SolidMemory receive_memory(const Participants& participants, MPI_Comm own, const YieldHook& yield = {});

class SolidLink {
 public:
  SolidLink(const Participants& participants, MPI_Comm own, const SolidTerms& terms, YieldHook yield = {});
  ~SolidLink();
  SolidLink(SolidLink&&) noexcept;

  [[nodiscard]] const FluidTerms& fluid() const;

  /// New plan; collective. `region`: this rank's subdomain (bodies with their centre in it are owned here).
  Epoch plan(const Box& region, std::span<const SolidBody> owned);

  /// After a plan with `checkpoint`: rank 0's memory is that of the side. Collective over the solids.
  void give_memory(std::span<const std::byte> memory);
  /// The loads last received, by body, in a run that continues and after a checkpoint: of all bodies that can be owned
  /// here in the next epoch, most simply of all.
  void take_up_loads(std::span<const std::pair<BodyTag, Load>> loads);

  /// Waits for the loads of the window from all fluid ranks in the plan.
  void receive_loads();
  /// Sum over the fluid ranks of the load on a body in the window last received; zero for a body out of the water.
  [[nodiscard]] Load load(BodyTag tag) const;
  /// Surface pressures received with the last loads (empty unless subscribed and due), all parts of each body.
  [[nodiscard]] const std::vector<BodyPressures>& surface_pressures() const;
  /// States at the end of the window of all bodies owned now (also those that moved here from another solid rank).
  void send_states(std::span<const SolidBody> owned);

  [[nodiscard]] const LinkCounters& counters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace embacle::coupling
