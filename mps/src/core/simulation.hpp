// The water of one rank and its time step.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/bodies.hpp"
#include "core/central_force.hpp"
#include "core/constants.hpp"
#include "core/corrections.hpp"
#include "core/decomposition.hpp"
#include "core/displacements.hpp"
#include "core/friction.hpp"
#include "core/guard.hpp"
#include "core/halo.hpp"
#include "core/light_bodies.hpp"
#include "core/neighbours.hpp"
#include "core/openings.hpp"
#include "core/operators.hpp"
#include "core/phases.hpp"
#include "core/sponges.hpp"
#include "core/structures.hpp"
#include "core/surface_loads.hpp"
#include "core/turbulence.hpp"
#include "core/wall_density.hpp"
#include "core/walls.hpp"
#include "embacle/coupling/link.hpp"
#include "output/checkpoint.hpp"

namespace embacle::mps {

/// Largest values seen since the start, over this rank's particles.
struct Extremes {
  double speed = 0;                  ///< [m/s]
  double compression = 0;            ///< |rho/rho0 - 1|
  double pressure = 0;               ///< [Pa]
  double shortest_step = 1e300;      ///< of all ranks [s]
  double imbalance = 1;              ///< of all lists that steps went through
  double imbalance_met = 1;          ///< also of lists that no step went through, before a new decomposition
  double body_penetration = -1e300;  ///< deepest place of a water particle below the surface of a body [m]
};

/// Counted since the start on this rank.
struct Counters {
  std::int64_t windows = 0;
  std::int64_t steps = 0;
  /// Those that had to be shorter than usual, by what limited them (adaptive steps only).
  std::array<std::int64_t, static_cast<std::size_t>(StepLimit::count)> limited_steps{};
  std::int64_t builds = 0;
  std::int64_t decompositions = 0;
  std::int64_t water_updates = 0;     ///< own water particles times steps
  std::int64_t particle_updates = 0;  ///< own water and wet solid points times steps
  std::int64_t pair_sweeps = 0;       ///< listed directed pairs (skin and padding included) times sweeps
};

/// Conservation over one window, over all ranks (see Simulation::audit).
struct Audit {
  double reaction_mismatch = 0;  ///< |loads applied by the solids - reaction on the water| / |reaction|
  double momentum_residual = 0;  ///< |change of momentum - gravity - walls - bodies| / (weight x time)
};

class Simulation {
 public:
  /// `link`: null for a scene without bodies. `restart`: continue from there. Collective.
  Simulation(const Scene& scene, MPI_Comm comm, coupling::FluidLink* link, const CheckpointReader* restart = nullptr);

  /// Starts an epoch: with solids a new decomposition if the work has become uneven, and a new plan of the coupling.
  /// Returns the number of windows to run; `wanted` is 0 to finish. Collective.
  int begin_epoch(int wanted_windows);
  /// One window: the scene's steps per window, then the exchange with the solids.
  void window();

  /// What this rank would like the run to do next (any numbers; 0: go on): the largest of all ranks' is agreed in every
  /// step, at no cost of its own.
  void request(int value) { requested_ = value; }
  [[nodiscard]] int agreed_request() const { return agreed_request_; }
  /// Throws InstabilityError if any rank has found a failure in its last step. Collective.
  void confirm() const;
  /// Adds all that a restart needs, also of the decomposition and the lists: a run continued on as many ranks does bit
  /// for bit what this one does. Valid until the next window; after a window, with bodies after the last one of an
  /// epoch. Collective, with bodies also for the solids.
  void save(CheckpointContent& content);

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double window_length() const { return longest_step_ * steps_per_window_; }
  [[nodiscard]] double longest_step() const { return longest_step_; }
  [[nodiscard]] const Constants& constants() const { return constants_; }
  [[nodiscard]] const Particles& particles() const { return particles_; }
  [[nodiscard]] const Neighbours& neighbours() const { return neighbours_; }
  [[nodiscard]] const Bodies* bodies() const { return bodies_ ? &*bodies_ : nullptr; }
  [[nodiscard]] const Openings* openings() const { return openings_ ? &*openings_ : nullptr; }
  [[nodiscard]] Structures* structures() { return structures_ ? &*structures_ : nullptr; }
  [[nodiscard]] const Walls& walls() const { return walls_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] const Extremes& extremes() const { return extremes_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Steps before the restart with which this run began.
  [[nodiscard]] std::int64_t earlier_steps() const { return earlier_steps_; }
  [[nodiscard]] const Audit& worst_audit() const { return worst_audit_; }
  /// What the water of this rank has given to solid points by compressing them since the start, and what the guard's
  /// springs hold [J]: in audited runs, the first with the leapfrog and without shifting only; otherwise 0.
  [[nodiscard]] double energy_in_solids() const {
    return scene_.output.audit ? energy_in_solids_ + guard_.stored_energy() : 0;
  }
  /// Work of all but water and gravity on the bodies that this rank speaks for, since the start [J].
  [[nodiscard]] double work_on_bodies() const { return work_on_bodies_; }
  [[nodiscard]] const Halo& halo() const { return halo_; }
  [[nodiscard]] Phases& phases() { return phases_; }
  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  [[nodiscard]] int rank() const { return rank_; }
  /// Largest work of a rank over the mean, by the last lists.
  [[nodiscard]] double imbalance() const { return imbalance_; }
  [[nodiscard]] std::int64_t removed_at_start() const { return removed_at_start_; }
  /// Water particles that made way for bodies which appeared later.
  [[nodiscard]] std::int64_t displaced_by_arrivals() const { return displaced_by_arrivals_; }
  [[nodiscard]] std::size_t bytes() const;
  /// By how much the velocity [m/s] of an own water particle is ahead of its position: half a step of the leapfrog.
  [[nodiscard]] Triple half_kick(std::size_t water) const;

 private:
  using Timer = Phases::Timer;
  /// A wall point as it is kept: most are dry.
  struct WallPoint {
    double at_zero[3];  ///< position at time zero [m]
    Identity identity;
  };

  void step(double share_of_window);
  [[nodiscard]] int steps_of_window();
  /// Whether the velocity of bodies changes in every step; otherwise only from window to window.
  [[nodiscard]] bool predicts() const { return scene_.coupling.predictor || steps_per_window_ == 1; }
  void step_symplectic();
  void move(double step);
  void move_walls(double step);
  void synchronise();                 ///< agrees on stale lists, on failures and on requests
  void find_neighbours(double time);  ///< `time` is that of the positions
  void renew_lists(double time);      ///< builds them, so that the ranks have about the same work
  void evaluate_forces(double time);  ///< `time` is that of the positions
  void integrate_velocities();
  void measure_imbalance();
  [[nodiscard]] bool uneven() const;
  void decompose();
  void restore(const CheckpointReader& checkpoint);
  void restore_wall_density(const CheckpointReader& checkpoint);
  [[nodiscard]] double failure_rank() const;
  void report_failure(double largest) const;
  void remove_water_in_bodies(std::int64_t newer_than = -1);
  void welcome_arrivals();
  void audit_step();
  void check_window();
  void check_bodies() const;
  [[nodiscard]] std::vector<Traveller> own_water() const;
  void adopt_bodies();
  void adopt_walls(const std::vector<Traveller>& points);
  void place_wall_points(double time);
  void accelerate_points(double time);
  [[nodiscard]] Record place_of(const WallPoint& point) const;
  void migrate_wall_points(double reach);
  [[nodiscard]] std::vector<Traveller> wall_points_near_water(double time);

  const Scene& scene_;
  MPI_Comm comm_;
  int rank_ = 0;
  coupling::FluidLink* link_;
  Constants constants_;
  Walls walls_;
  Decomposition decomposition_;
  Friction friction_;
  Guard guard_;
  Halo halo_;
  Neighbours neighbours_;
  Displacements displacements_;
  Particles particles_;
  /// All wall points in this rank's part of space; those near water have a copy among the particles.
  std::vector<WallPoint> wall_points_;
  std::optional<WallDensity> wall_density_;
  std::vector<Pose> wall_pose_;  ///< of each wall at the last build; empty: all at rest
  double built_at_ = 0;          ///< time of the last build [s]
  double wall_travel_ = 0;       ///< farthest way of a wall since then [m]
  std::optional<Bodies> bodies_;
  std::optional<Corrections> corrections_;
  std::optional<Turbulence> turbulence_;
  std::optional<SurfaceLoads> surface_loads_;
  std::optional<Openings> openings_;
  std::optional<LightBodies> light_bodies_;  ///< where the scene has any
  std::optional<CentralForce> central_force_;
  std::optional<Structures> structures_;
  std::optional<Sponges> sponges_;
  int steps_per_window_ = 1;

  std::vector<Record> start_;         ///< own particles at the start of a step of step_symplectic()
  std::vector<Triple> acceleration_;  ///< of the own water in the last step; empty: none since the last order
  std::vector<Triple> point_acceleration_;
  Reactions reaction_;
  std::vector<coupling::Load> load_;         ///< this rank's part of the load on each body
  std::vector<coupling::Load> guard_loads_;  ///< of the guard on each wall
  std::vector<coupling::Load> window_load_;  ///< mean partial load over the window so far
  bool lists_valid_ = false;
  bool anywhere_ = true;  ///< the next migration follows a new decomposition
  double time_ = 0;
  double imbalance_ = 1;
  double evened_imbalance_ = 1;  ///< right after the last decomposition that uneven lists called for
  double longest_step_ = 0;      ///< [s]
  Motions own_motions_;          ///< of the own water and bodies, in the last step
  Motions motions_;              ///< of all ranks, in the step before
  std::int64_t removed_at_start_ = 0, displaced_by_arrivals_ = 0;
  std::int64_t newest_tag_ = -1;  ///< of all bodies so far, on any rank
  bool started_ = false;
  bool just_saved_ = false;  ///< or just restored: no window since
  std::int64_t earlier_steps_ = 0;
  int requested_ = 0, agreed_request_ = 0;
  std::string failure_;                                  ///< set by the rank that finds the simulation broken
  Triple window_momentum_change_{}, window_reaction_{};  ///< beyond that by gravity; on solids
  std::vector<std::string> warnings_;
  Extremes extremes_;
  Counters counters_;
  Audit worst_audit_;
  double work_on_bodies_ = 0;  ///< with the energy of those that came, less that of those that went [J]
  bool bodies_known_ = false;  ///< from a plan
  std::vector<coupling::FluidBody> window_start_;        ///< the bodies, as they were
  double energy_in_solids_ = 0, power_into_solids_ = 0;  ///< by this rank's water [J], in the last step [W]
  Phases phases_;
};

/// What the solids need to continue from a checkpoint: theirs, not read here.
[[nodiscard]] std::vector<std::byte> solid_memory(const CheckpointReader& checkpoint);

}  // namespace embacle::mps
