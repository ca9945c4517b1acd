// Conservation, checked in every window where the scene asks for it (output.audit).
#include <cmath>

#include "core/simulation.hpp"

namespace embacle::mps {

/// The impulse of a step on the water less what gravity and the central force gave, and that on everything solid.
void Simulation::audit_step() {
  for (const Triple& a : acceleration_) {
    for (int c = 0; c < 3; ++c)
      window_momentum_change_[c] += constants_.particle_mass * constants_.step * (a[c] - constants_.gravity[c]);
  }
  for (std::size_t i = 0; central_force_ && i < particles_.water; ++i) {
    const Triple a = central_force_->at(particles_.record[i].x);
    for (int c = 0; c < 3; ++c) window_momentum_change_[c] -= constants_.particle_mass * constants_.step * a[c];
  }
  // Reaction on everything solid: on walls by their points and by the guard, on bodies by their loads.
  for (std::size_t j = particles_.water; j < particles_.all(); ++j) {
    if (particles_.is_water(j) || particles_.identity[j].owner >= walls_.count()) continue;
    for (int c = 0; c < 3; ++c)
      window_reaction_[c] += constants_.step * reaction_.total()[reaction_slot(particles_, j)][c];
  }
  for (const auto* loads : {&guard_loads_, &load_}) {
    for (const auto& load : *loads) {
      for (int c = 0; c < 3; ++c) window_reaction_[c] += constants_.step * load.force[c];
    }
  }
  if (scene_.numerics.integrator == Integrator::leapfrog && !corrections_) {
    const double power = power_into_solids(particles_, neighbours_, constants_, acceleration_);
    energy_in_solids_ += 0.5 * constants_.step * (power_into_solids_ + power);
    power_into_solids_ = power;
  }
}

/// Conservation over the window just finished. The momentum of the water may change by gravity and by the walls and
/// bodies only; the loads that the solids applied must be the reaction that the water felt.
void Simulation::check_window() {
  double sums[12] = {};
  const double mass = constants_.particle_mass * static_cast<double>(particles_.water);
  for (int c = 0; c < 3; ++c) {
    sums[c] = window_momentum_change_[c] + window_reaction_[c];
  }
  if (bodies_) {
    for (std::size_t b = 0; b < bodies_->count(); ++b) {
      const auto& body = bodies_->all()[b];
      for (int c = 0; c < 3; ++c) {
        sums[3 + c] += window_load_[b].force[c];
        if (speaks_for(rank_, body)) sums[6 + c] += body.applied.force[c];
      }
    }
  }
  sums[9] = mass;
  double total[12];
  MPI_Allreduce(sums, total, 12, MPI_DOUBLE, MPI_SUM, comm_);
  const auto norm = [](const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); };
  const double difference[3] = {total[3] - total[6], total[4] - total[7], total[5] - total[8]};
  if (norm(total + 3) > 0 && scene_.coupling.scheme == Scheme::serial) {
    worst_audit_.reaction_mismatch = std::max(worst_audit_.reaction_mismatch, norm(difference) / norm(total + 3));
  }
  const double weight = total[9] * window_length() * norm(constants_.gravity);
  if (weight > 0) worst_audit_.momentum_residual = std::max(worst_audit_.momentum_residual, norm(total) / weight);
  for (std::size_t i = 0; bodies_ && i < particles_.water; ++i) {
    extremes_.body_penetration = std::max(extremes_.body_penetration, bodies_->penetration(particles_.record[i].x));
  }
}

}  // namespace embacle::mps
