#include "core/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/filling.hpp"

namespace embacle::mps {

namespace {

/// Work of a particle beside its pairs, in pairs; and all of it where no lists are known yet.
constexpr double work_of_particle = 8;
constexpr float expected_work = 60;
/// By how much, in particle distances, the decomposition's boxes may miss a particle of their rank.
constexpr double tie_offset = 1e-6;

double extents(const Scene& scene) {  // of the domain, all together [m]
  double sum = 0;
  for (int c = 0; c < scene.dimension; ++c) sum += scene.domain.upper[c] - scene.domain.lower[c];
  return sum;
}

}  // namespace

// ---------------------------------------------------------------------------------------------------------------------
// The time step. A leapfrog whose sweeps all use the same positions, so that one neighbour geometry serves a step:
// positions, then density and pressure, then velocities (docs/numerics.md).

void Simulation::step(double share_of_window) {
  if (scene_.numerics.integrator == Integrator::symplectic) {
    step_symplectic();
    time_ += constants_.step;
    ++counters_.steps;
    return;
  }
  move(constants_.step);
  if (lists_valid_) {
    const Timer timer(phases_, Phase::halo);
    halo_.update_motion(particles_);
  }
  synchronise();
  if (!lists_valid_) renew_lists(time_ + constants_.step);
  if (corrections_) {
    const Timer timer(phases_, Phase::corrections);
    corrections_->update(particles_, neighbours_, halo_, motions_.water);
  }
  {
    const Timer timer(phases_, Phase::continuity);
    if (corrections_) {
      corrections_->advance_density(particles_, neighbours_);
    } else {
      advance_density(particles_, neighbours_, constants_);
    }
    if (central_force_) central_force_->correct_density(particles_, neighbours_);
  }
  evaluate_forces(time_ + constants_.step);
  integrate_velocities();
  if (bodies_) {
    const Timer timer(phases_, Phase::bodies);
    for (std::size_t b = 0; b < load_.size(); ++b) {
      window_load_[b].force += share_of_window * load_[b].force;
      window_load_[b].torque += share_of_window * load_[b].torque;
    }
    if (predicts() && share_of_window < 1) {
      link_->sum_over_sharers(load_);
      bodies_->predict(load_, constants_.step);
    }
  }
  time_ += constants_.step;
  ++counters_.steps;
}

void Simulation::window() {
  if (bodies_) {
    window_load_.assign(bodies_->count(), {});
    window_start_ = bodies_->all();
  }
  window_momentum_change_ = window_reaction_ = {};
  const int steps = steps_of_window();
  constants_.step = window_length() / steps;
  for (int s = 0; s < steps; ++s) step(1.0 / steps);
  if (bodies_) {
    const Timer timer(phases_, Phase::coupling);
    std::vector<coupling::BodyPressures> pressures;
    if (link_->surface_pressures_due()) pressures = bodies_->surface_pressures(particles_);
    link_->send_loads(window_load_, pressures);
    link_->receive_states();
    bodies_->assign(link_->bodies());
    work_on_bodies_ += bodies_->work_of_contacts(window_start_, window_length(), rank_);
  }
  if (scene_.output.audit) check_window();
  ++counters_.windows;
}

/// As many as the scene says, or with adaptive steps as many as the motions of the step before ask for.
int Simulation::steps_of_window() {
  if (!scene_.numerics.adaptive_step) return steps_per_window_;
  const auto [longest, limit] = mps::longest_step(constants_, motions_);
  const double needed = std::ceil(window_length() / longest * (1 - 1e-12));
  if (!(needed < 1000.0 * steps_per_window_)) {
    throw coupling::InstabilityError(fmt::format(
        "step {}, t = {:.6g} s: the {} limit asks for a time step of {:.3g} s, a {:.0f}th of the usual one: water up "
        "to {:.4g} m/s and {:.4g} m/s2, bodies up to {:.4g} m/s",
        counters_.steps, time_, name_of(limit), longest, longest_step_ / longest, motions_.water, motions_.acceleration,
        motions_.bodies));
  }
  const int steps = std::max(steps_per_window_, static_cast<int>(needed));
  if (steps > steps_per_window_) counters_.limited_steps[static_cast<std::size_t>(limit)] += steps;
  extremes_.shortest_step = std::min(extremes_.shortest_step, window_length() / steps);
  return steps;
}

// ---------------------------------------------------------------------------------------------------------------------

void Simulation::move(double step) {
  const Timer timer(phases_, Phase::integration);
  for_each(particles_.water, [&](std::size_t i, int) {
    Record& record = particles_.record[i];
    for (int c = 0; c < 3; ++c) record.x[c] += step * record.v[c];
  });
  move_walls(step);
  if (bodies_) {
    bodies_->drift(step);
    bodies_->place_points(particles_);
  }
}

void Simulation::move_walls(double step) {
  if (walls_.any_moves()) {
    const std::vector<Stride> strides = walls_.strides(time_, time_ + step, step);
    for (std::size_t j = particles_.water; j < particles_.own(); ++j) {
      const int owner = particles_.identity[j].owner;
      if (owner >= walls_.count()) continue;
      Record& record = particles_.record[j];
      const Stride& stride = strides[owner];
      const Vec3d velocity = stride.after.turned
                                 ? stride.velocity_of(stride.before.zero({record.x[0], record.x[1], record.x[2]}))
                                 : stride.velocity;
      for (int c = 0; c < 3; ++c) {
        record.v[c] = velocity[c];
        record.x[c] += step * record.v[c];
      }
    }
    wall_travel_ = walls_.travel(built_at_, time_ + step);
  }
}

void Simulation::synchronise() {
  double stale = 1;
  if (lists_valid_) {
    const Timer timer(phases_, Phase::search);
    // Dry points of a wall stand in no list: what they have moved counts as well.
    const bool hold = displacements_.lists_hold(particles_) && wall_travel_ <= constants_.skin;
    stale = hold && !(openings_ && openings_->due(time_ + constants_.step)) ? 0 : 1;
  }
  const Timer timer(phases_, Phase::synchronisation);
  // Agreed by one reduction: whether any lists are stale, the lowest rank that has found a failure, the largest
  // request, the largest motions.
  const double local[6] = {stale,
                           failure_rank(),
                           static_cast<double>(requested_),
                           own_motions_.water,
                           own_motions_.bodies,
                           own_motions_.acceleration};
  double global[6];
  MPI_Allreduce(local, global, 6, MPI_DOUBLE, MPI_MAX, comm_);
  if (global[1] > 0) report_failure(global[1]);
  agreed_request_ = static_cast<int>(global[2]);
  if (global[0] > 0) lists_valid_ = false;
  motions_ = {global[3], global[4], global[5]};
}

/// Zero without a failure; otherwise the larger, the lower the rank.
double Simulation::failure_rank() const {
  int size = 1;
  MPI_Comm_size(comm_, &size);
  return failure_.empty() ? 0.0 : static_cast<double>(size - rank_);
}

void Simulation::report_failure(double largest) const {
  if (largest == failure_rank()) throw coupling::InstabilityError(failure_);
  MPI_Barrier(comm_);  // the rank that speaks ends the run
}

void Simulation::confirm() const {
  double largest = failure_rank();
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, comm_);
  if (largest > 0) report_failure(largest);
}

void Simulation::find_neighbours(double time) {
  const double reach =
      Displacements::reach(constants_.support, constants_.skin) + tie_offset * constants_.particle_distance;
  const bool exchanged = openings_ && openings_->due(time);
  std::vector<Traveller> solid;
  if (wall_density_) wall_density_->keep(particles_);
  {
    const Timer timer(phases_, Phase::search);
    auto water = own_water();
    if (constants_.periodic.any()) {
      for (Traveller& traveller : water) constants_.periodic.wrap(traveller.record.x);
    }
    if (exchanged) openings_->exchange(water, time, decomposition_);
    halo_.migrate(decomposition_, reach, anywhere_, water);
    place_wall_points(time);
    if (anywhere_ || walls_.any_moves()) migrate_wall_points(reach);
    anywhere_ = false;
    particles_.assign(water, neighbours_.cell_order(water));
    acceleration_.clear();
  }
  std::vector<Traveller> ghost_water, ghost_solid;
  {
    const Timer timer(phases_, Phase::halo);
    ghost_water = halo_.exchange_water(decomposition_, reach, particles_);
  }
  {
    const Timer timer(phases_, Phase::search);
    neighbours_.survey(particles_, ghost_water);
    solid = wall_points_near_water(time);
    if (bodies_) bodies_->collect_points(decomposition_, solid);
  }
  {
    const Timer timer(phases_, Phase::halo);
    ghost_solid = halo_.exchange_solid(decomposition_, reach, solid, particles_.water);
    particles_.append(solid, ghost_water, ghost_solid);
    halo_.assemble(particles_);
  }
  const Timer timer(phases_, Phase::search);
  if (bodies_) bodies_->resolve_owners(particles_);
  neighbours_.build(particles_, walls_, walls_.thin_walls(time));
  if (bodies_) bodies_->note_water_nearby(particles_, neighbours_);
  guard_.forget(particles_.water);
  if (openings_) openings_->list(particles_, exchanged);
  displacements_.remember(particles_);
  lists_valid_ = true;
  built_at_ = time;
  wall_travel_ = 0;
  ++counters_.builds;
}

/// What the extrapolation takes off gravity at the wet points; empty: nothing.
void Simulation::accelerate_points(double time) {
  const auto& wet = neighbours_.wet_points();
  point_acceleration_.clear();
  if (scene_.numerics.wall_pressure == WallPressure::zero_gradient) {  // as if they fell freely
    point_acceleration_.assign(wet.size(), std::to_array(constants_.static_gravity));
    return;
  }
  if (bodies_) {
    bodies_->point_accelerations(particles_, neighbours_, point_acceleration_);
  } else if (walls_.any_accelerates() || central_force_) {
    point_acceleration_.assign(wet.size(), Triple{});
  }
  for (std::size_t k = 0; walls_.any_accelerates() && k < wet.size(); ++k) {
    const int owner = particles_.identity[wet[k]].owner;
    if (owner < walls_.count() && walls_.course(owner).accelerates())
      point_acceleration_[k] = walls_.course(owner).acceleration(time, particles_.record[wet[k]].x);
  }
  if (central_force_) central_force_->relieve_points(particles_, neighbours_, point_acceleration_);
}

/// What needs no ghosts is done while the exchanges are on their way.
void Simulation::evaluate_forces(double time) {
  const auto timed = [&](Phase phase, const auto& work) {
    const Timer timer(phases_, phase);
    work();
  };
  const auto extrapolate = [&](Part part) {
    const Timer timer(phases_, Phase::walls);
    extrapolate_pressure(particles_, neighbours_, constants_, point_acceleration_, part);
  };
  const auto press = [&](Part part) {
    const Timer timer(phases_, Phase::forces);
    accelerate(particles_, neighbours_, constants_, acceleration_, reaction_, part);
  };
  accelerate_points(time);
  timed(Phase::halo, [&] { halo_.start_water_state(particles_); });
  if (!wall_density_) extrapolate(Part::inner);
  timed(Phase::halo, [&] { halo_.finish(); });
  if (wall_density_) {
    timed(Phase::walls, [&] { wall_density_->advance(particles_, neighbours_); });
  } else {
    extrapolate(Part::rim);
  }
  timed(Phase::halo, [&] { halo_.start_solid_pressure(particles_); });
  if (!corrections_) press(Part::inner);
  timed(Phase::halo, [&] { halo_.finish(); });
  if (corrections_) {
    timed(Phase::forces, [&] { corrections_->accelerate(particles_, neighbours_, acceleration_, reaction_); });
  } else {
    press(Part::rim);
  }
  timed(Phase::forces, [&] {
    if (turbulence_) turbulence_->apply(particles_, neighbours_, halo_, acceleration_);
    friction_.apply(particles_, neighbours_, time, acceleration_, reaction_);
    if (central_force_) central_force_->accelerate(particles_, acceleration_);
    reaction_.join();
  });
  const Timer timer(phases_, Phase::bodies);
  if (surface_loads_) {
    load_ = surface_loads_->partial_loads(particles_, *bodies_);
  } else if (bodies_) {
    load_ = bodies_->partial_loads(particles_, reaction_.total());
  }
  guard_.apply(particles_, neighbours_, bodies(), time, constants_.step, acceleration_, guard_loads_, load_);
  if (structures_) structures_->add(particles_, reaction_.total(), guard_loads_, constants_.step);
  if (light_bodies_) {
    light_bodies_->apply(particles_, neighbours_, *bodies_, *link_, predicts() ? constants_.step : window_length(),
                         counters_.steps == 0, acceleration_, load_);
  }
}

void Simulation::integrate_velocities() {
  const Timer timer(phases_, Phase::integration);
  struct alignas(64) Found {
    double speed_square = 0, acceleration_square = 0, compression = 0, pressure = 0;
    std::string failure;
  };
  std::vector<Found> parts(threads());
  for_each(particles_.water, [&](std::size_t i, int thread) {
    Found& part = parts[thread];
    Record& record = particles_.record[i];
    double square = 0, acceleration_square = 0;
    for (int c = 0; c < 3; ++c) {
      record.v[c] += constants_.step * acceleration_[i][c];
      square += record.v[c] * record.v[c];
      acceleration_square += acceleration_[i][c] * acceleration_[i][c];
    }
    part.acceleration_square = std::max(part.acceleration_square, acceleration_square);
    part.speed_square = std::max(part.speed_square, square);
    part.compression = std::max(part.compression, std::abs(record.s - 1.0));
    part.pressure = std::max(part.pressure, record.p);
    const bool inside = [&] {
      for (int c = 0; c < constants_.dimension; ++c) {
        if (constants_.periodic.in(c)) continue;
        if (record.x[c] < scene_.domain.lower[c] || record.x[c] > scene_.domain.upper[c]) return false;
      }
      return true;
    }();
    const bool sane = square < constants_.sound_speed * constants_.sound_speed && record.s > 0.5 && record.s < 2.0;
    if ((!inside || !sane) && part.failure.empty()) {
      part.failure = fmt::format(
          "step {}, t = {:.6g} s: water particle {} at ({:.5g}, {:.5g}, {:.5g}) m {}: speed {:.4g} m/s (sound speed "
          "{:.4g}), "
          "density {:.4g} of rest",
          counters_.steps, time_, particles_.identity[i].id, record.x[0], record.x[1], record.x[2],
          inside ? "is unstable" : "left the domain", std::sqrt(square), constants_.sound_speed, record.s);
    }
  });
  if (sponges_) sponges_->damp(particles_, constants_.step);
  if (openings_) openings_->drive(particles_);
  if (corrections_) {  // now, so that a step leaves nothing behind but the particles
    for_each(particles_.water, [&](std::size_t i, int) {
      for (int c = 0; c < 3; ++c) particles_.record[i].x[c] += constants_.step * corrections_->shift()[i][c];
    });
  }
  if (scene_.output.audit) audit_step();
  own_motions_ = {0, bodies_ ? bodies_->fastest() : 0, 0};
  for (const Found& part : parts) {
    own_motions_.water = std::max(own_motions_.water, std::sqrt(part.speed_square));
    own_motions_.acceleration = std::max(own_motions_.acceleration, std::sqrt(part.acceleration_square));
    extremes_.compression = std::max(extremes_.compression, part.compression);
    extremes_.pressure = std::max(extremes_.pressure, part.pressure);
    if (failure_.empty()) failure_ = part.failure;
  }
  extremes_.speed = std::max(extremes_.speed, own_motions_.water);
  counters_.water_updates += static_cast<std::int64_t>(particles_.water);
  counters_.particle_updates += static_cast<std::int64_t>(particles_.water + neighbours_.wet_points().size());
  counters_.pair_sweeps += static_cast<std::int64_t>(2 * neighbours_.pairs());
}

// ---------------------------------------------------------------------------------------------------------------------

Simulation::Simulation(const Scene& scene, MPI_Comm comm, coupling::FluidLink* link, const CheckpointReader* restart)
    : scene_(scene),
      comm_(comm),
      link_(link),
      constants_(constants_of(scene)),
      walls_(scene, scene.dimension, constants_.layers),
      decomposition_(comm, constants_.periodic, tie_offset * constants_.particle_distance / extents(scene)),
      friction_(scene, constants_, walls_),
      guard_(scene, constants_, walls_),
      halo_(comm),
      neighbours_(scene.dimension, constants_.support + constants_.skin),
      displacements_(constants_.support, constants_.skin),
      steps_per_window_(link != nullptr ? scene.coupling.steps_per_window : 1) {
  longest_step_ = constants_.step;
  if (shifts(scene.numerics.regularisation)) corrections_.emplace(constants_);
  if (scene.numerics.wall_pressure == WallPressure::continuity) wall_density_.emplace(constants_);
  if (constants_.smagorinsky > 0) turbulence_.emplace(constants_);
  if (constants_.central_force > 0) central_force_.emplace(constants_);
  if (std::ranges::any_of(scene.walls, &Wall::forces)) structures_.emplace(scene);
  if (!scene.sponges.empty()) sponges_.emplace(scene, constants_);
  MPI_Comm_rank(comm, &rank_);
  if (link_ != nullptr) adopt_bodies();
  if (restart != nullptr) {
    restore(*restart);
    return;
  }
  int size = 1;
  MPI_Comm_size(comm, &size);
  InitialParticles initial = fill(scene, constants_, walls_, rank_, size);
  warnings_.insert(warnings_.end(), initial.warnings.begin(), initial.warnings.end());
  if (!scene.openings.empty()) {
    openings_.emplace(scene, constants_, walls_, comm);
    openings_->start(initial.water, initial.next_id, rank_, size);
  }
  particles_.assign(initial.water);
  adopt_walls(initial.walls);
  decompose();
}

int Simulation::begin_epoch(int wanted_windows) {
  if (started_) synchronise();  // also after the last step: its failure must not go unsaid
  int windows = wanted_windows;
  if (link_ != nullptr) {
    if (wanted_windows > 0 && started_ && !just_saved_ && uneven()) decompose();
    const Timer timer(phases_, Phase::coupling);
    coupling::Epoch proposal{wanted_windows, window_length(), time_, false};
    windows = link_->plan(decomposition_.own(), proposal).windows;
    if (windows > 0) {
      just_saved_ = false;
      // The energy of bodies that came or went: of all that stay, another rank may speak now, but the sum is the same.
      const auto energy = [&] {
        const auto [kinetic, potential] = bodies_->energy(rank_);
        return kinetic + potential;
      };
      const double before = energy();
      bodies_->assign(link_->bodies());
      if (bodies_known_) work_on_bodies_ += energy() - before;
      bodies_known_ = true;
      lists_valid_ = false;
      welcome_arrivals();
      check_bodies();
    }
  }
  if (!started_ && windows > 0) {
    if (bodies_) {
      find_neighbours(time_);
      remove_water_in_bodies();
    }
    renew_lists(time_);                                           // the first decomposition knew no lists
    if (bodies_ && scene_.coupling.scheme == Scheme::parallel) {  // the solids start from the load at rest
      evaluate_forces(time_);
      link_->send_loads(load_);
    }
    started_ = true;
  }
  return windows;
}

/// The work of the ranks changes when lists are built, and only then: planes of a lattice that a cut passes through
/// change sides as a whole, and a front grows by a tenth within a few builds. Therefore it is shared out anew before
/// any step goes through uneven lists; but with solids, whose plan rests on the decomposition, when an epoch begins.
void Simulation::renew_lists(double time) {
  find_neighbours(time);
  measure_imbalance();
  const double met = started_ ? imbalance_ : 1;  // the first lists are made to decompose by
  if (link_ == nullptr && uneven()) {
    decompose();
    find_neighbours(time);
    measure_imbalance();
    evened_imbalance_ = imbalance_;
  }
  extremes_.imbalance = std::max(extremes_.imbalance, imbalance_);
  extremes_.imbalance_met = std::max({extremes_.imbalance_met, extremes_.imbalance, met});
}

/// Where the last decomposition did not get below the limit, as with few particles a rank, only worse calls for
/// another.
bool Simulation::uneven() const {
  const double limit = scene_.numerics.rebalance_imbalance;
  return imbalance_ > (evened_imbalance_ > limit ? evened_imbalance_ + 0.05 : limit);
}

/// Of the work of the ranks: what their sweeps go through.
void Simulation::measure_imbalance() {
  const Timer timer(phases_, Phase::synchronisation);
  const double work =
      static_cast<double>(neighbours_.pairs()) + work_of_particle * static_cast<double>(particles_.own());
  double sum = 0, largest = 0;
  int size = 1;
  MPI_Comm_size(comm_, &size);
  MPI_Allreduce(&work, &sum, 1, MPI_DOUBLE, MPI_SUM, comm_);
  MPI_Allreduce(&work, &largest, 1, MPI_DOUBLE, MPI_MAX, comm_);
  imbalance_ = sum > 0 ? largest * size / sum : 1.0;
}

void Simulation::decompose() {
  const Timer timer(phases_, Phase::search);
  std::vector<double> positions;
  std::vector<float> weights;
  const auto add = [&](const Record& record, float weight) {
    positions.insert(positions.end(), record.x, record.x + 3);
    constants_.periodic.wrap(positions.data() + positions.size() - 3);
    weights.push_back(weight);
  };
  const auto work_of = [](const NeighbourRange& range) {
    return static_cast<float>(work_of_particle + static_cast<double>(range.end - range.begin));
  };
  const bool listed = neighbours_.water(Part::all).size() == particles_.water && particles_.water > 0;
  for (std::size_t i = 0; i < particles_.water; ++i) {
    add(particles_.record[i], listed ? work_of(neighbours_.of_water(i)) : expected_work);
  }
  for (const WallPoint& point : wall_points_) add(place_of(point), 0.02F * expected_work);
  // Of the wall points near water some are dry all the same, but are work as particles are.
  std::vector<float> near_water(particles_.solid, work_of_particle);
  const auto& wet = neighbours_.wet_points();
  for (std::size_t k = 0; k < wet.size(); ++k)
    near_water[wet[k] - particles_.water] = work_of(neighbours_.of_wet_point(k));
  for (std::size_t j = particles_.water; j < particles_.own(); ++j) {
    if (particles_.identity[j].owner < walls_.count()) add(particles_.record[j], near_water[j - particles_.water]);
  }
  decomposition_.partition(scene_.dimension, positions, weights);
  anywhere_ = true;
  lists_valid_ = false;
  ++counters_.decompositions;
}

std::vector<Traveller> Simulation::own_water() const {
  std::vector<Traveller> result(particles_.water);
  for_each(particles_.water, [&](std::size_t i, int) { result[i] = {particles_.record[i], particles_.identity[i]}; });
  return result;
}

Triple Simulation::half_kick(std::size_t water) const {
  if (scene_.numerics.integrator != Integrator::leapfrog || acceleration_.empty()) return {};
  const Triple& a = acceleration_[water];
  const double half = 0.5 * constants_.step;
  return {half * a[0], half * a[1], half * a[2]};
}

std::size_t Simulation::bytes() const {
  return particles_.record.capacity() * (sizeof(Record) + sizeof(Identity)) + start_.capacity() * sizeof(Record) +
         neighbours_.bytes() + wall_points_.capacity() * sizeof(WallPoint) + acceleration_.capacity() * sizeof(Triple) +
         reaction_.bytes() + displacements_.bytes() + (bodies_ ? bodies_->bytes() : 0) +
         (corrections_ ? corrections_->bytes() : 0) + (turbulence_ ? turbulence_->bytes() : 0) +
         (wall_density_ ? wall_density_->bytes() : 0);
}

}  // namespace embacle::mps
