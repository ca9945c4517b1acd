// Open boundaries: zones in which water enters a reach or leaves it.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "core/constants.hpp"
#include "core/decomposition.hpp"
#include "core/particles.hpp"
#include "core/walls.hpp"
#include "scene/scene.hpp"

namespace embacle::mps {

/// Open boundaries of a scene (docs/open-boundaries.md).
///
/// Water in the zone of an inflow stands in rows along the flow and moves with them; each row is continued at its outer
/// end, so that exactly the discharge enters. Water in the zone of an outflow keeps the profile with which it came; its
/// mean velocity follows the level upstream of the zone, so that long waves go out (after Flather 1976). What has
/// passed the zone is taken away, as is what enters a drain.
///
/// Particles enter and leave now and then, when they are due: the same on any number of ranks, which do not build their
/// lists at the same steps. Between two exchanges the same particles are driven.
class Openings {
 public:
  /// Collective.
  Openings(const Scene& scene, const Constants& constants, const Walls& walls, MPI_Comm comm);

  [[nodiscard]] std::size_t count() const { return states_.size(); }

  /// At the start: replaces the water in the zones of inflows by their rows. `next_id`: first identity that is free.
  /// Collective.
  void start(std::vector<Traveller>& water, std::int64_t next_id, int rank, int size);
  /// Whether the next build of lists goes with an exchange.
  [[nodiscard]] bool due(double time) const { return time - time_ >= interval_; }
  /// Makes the next exchange due at once, as after a restart.
  void hasten() { interval_ = 0; }
  /// Measures the levels, sets the velocities until the next call, adds what has entered since the last one to the rank
  /// that owns the place, and drops what has left. Collective.
  void exchange(std::vector<Traveller>& water, double time, const Decomposition& decomposition);
  /// Notes which of the own water is driven, after it was sorted: what is in the zones if there was an exchange
  /// (collective), else what was driven before.
  void list(Particles& particles, bool exchanged);
  /// Sets the velocities of what was listed, in place of those that the forces have made in a step.
  void drive(Particles& particles) const;

  /// What passed since the start [m3], the level that the water has there [m], and the velocity of the zone [m/s].
  struct Passage {
    double volume = 0, level = 0, speed = 0;
  };
  /// Volumes are sums over all ranks. Collective.
  [[nodiscard]] std::vector<Passage> passages() const;

  /// All that a restart needs, the same on every rank. Collective.
  [[nodiscard]] std::vector<double> save() const;
  /// Throws InputError unless the numbers are of these openings.
  void restore(const std::vector<double>& numbers);

 private:
  struct Row {
    double place[3];    ///< at the outer end of the zone, in the middle of the row [m]
    double owed = 0.5;  ///< particles that should have entered and have not
  };
  struct State {
    std::vector<Row> rows;         ///< of an inflow
    std::vector<double> of_layer;  ///< area of the cross-section in each layer of its lattice, from below [m2]
    std::vector<double> bed_of;    ///< of an inflow: height of the bed below each site, layer by layer [m]
    bool known = false;            ///< the level has been measured
    double level = 0;              ///< of the water at the zone, filtered [m]
    double slow = 0;               ///< mean velocity about which that of an outflow varies [m/s]
    double speed = 0;              ///< of the zone [m/s]
    std::int64_t passed = 0;       ///< particles; of an inflow on all ranks, else on this one
  };
  struct Driven {
    std::uint32_t particle;
    std::int32_t opening;
    double speed;          ///< along the flow [m/s]
    double density_ratio;  ///< kept in an outflow: there fast water runs into slow water without feeling it
  };

  /// A ghost of another rank's driven water, in an outflow: its velocity comes with the halo, its density does not.
  struct DrivenGhost {
    std::uint32_t particle;
    double density_ratio;
  };

  [[nodiscard]] int axis(std::size_t k) const { return axis_of(scene_.openings[k].direction); }
  [[nodiscard]] double sign(std::size_t k) const { return sign_of(scene_.openings[k].direction); }
  /// Distance [m] that a place has gone into a zone, in the direction of the flow.
  [[nodiscard]] double into(std::size_t k, const double* x) const;
  [[nodiscard]] bool within_section(std::size_t k, const double* x) const;
  [[nodiscard]] bool in_zone(std::size_t k, const double* x) const;
  void lay_rows(std::size_t k, const Walls& walls);
  [[nodiscard]] double area_below(std::size_t k, double level) const;
  [[nodiscard]] double level_of(std::size_t k, double area) const;
  [[nodiscard]] double share(std::size_t k, const Row& row) const;
  [[nodiscard]] double profile(std::size_t k, const double* x) const;
  void choose_interval();
  void list_ghosts(const Particles& particles, bool exchanged);
  void measure(const std::vector<Traveller>& water, double passed_time);
  void set_inflow(std::size_t k, double measured, double passed_time);
  void set_outflow(std::size_t k, double measured, double mean_speed, double passed_time);
  [[nodiscard]] Traveller particle_of(std::size_t k, const Row& row, double way);

  const Scene& scene_;
  const Constants& constants_;
  MPI_Comm comm_;
  int up_ = 2;  ///< axis against gravity
  std::vector<State> states_;
  std::vector<Driven> driven_;
  std::vector<DrivenGhost> driven_ghosts_;
  std::int64_t next_id_ = 0;
  double time_ = 0;      ///< of the last exchange [s]
  double interval_ = 0;  ///< to the next [s]
};

}  // namespace embacle::mps
