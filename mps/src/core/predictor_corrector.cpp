// The other time step of Simulation: a predictor and a corrector, each with all sweeps.
#include <algorithm>

#include "core/simulation.hpp"

namespace embacle::mps {

/// `integrator = "predictor_corrector"`: the explicit midpoint rule (thesis Figure 5.1 and eq 5.22-5.24 for the half
/// step, with the accelerations of its start; eq 5.25 for the velocity, and the trapezoidal rule in place of eq 5.26
/// and 5.27's half steps):
///   r', v', s' = r + dt/2 v, v + dt/2 a(r, v, s), s + dt/2 ds/dt(r, v, s)
///   v += dt a(r', v', s');  s += dt ds/dt(r', v', s');  r += dt (v before + v after)/2.
/// A step leaves positions, velocities and densities of the same time, and nothing else.
void Simulation::predict_and_correct() {
  const double whole = constants_.step, half = 0.5 * whole;
  // Lists must hold until mid-step. They are built at the start, so that the order of the particles stays.
  start_.assign(particles_.record.begin(), particles_.record.begin() + static_cast<std::ptrdiff_t>(particles_.own()));
  const auto back_to_start = [&] { std::copy(start_.begin(), start_.end(), particles_.record.begin()); };
  move(half);
  synchronise();
  back_to_start();
  if (lists_valid_) {
    const Timer timer(phases_, Phase::halo);
    halo_.update_motion(particles_);
  } else {
    find_neighbours(time_);
    start_.assign(particles_.record.begin(), particles_.record.begin() + static_cast<std::ptrdiff_t>(particles_.own()));
  }

  evaluate_forces(time_);
  {
    const Timer timer(phases_, Phase::continuity);
    advance_density(particles_, neighbours_, constants_, half, 0);
  }
  move(half);
  {
    const Timer timer(phases_, Phase::integration);
    for_each(particles_.water, [&](std::size_t i, int) {
      for (int c = 0; c < 3; ++c) particles_.record[i].v[c] += half * acceleration_[i][c];
      start_[i].s -= particles_.record[i].s;  // what the whole step adds goes on top of the half one
    });
  }
  {
    const Timer timer(phases_, Phase::halo);
    halo_.update_motion(particles_);
  }

  evaluate_forces(time_ + half);
  {
    const Timer timer(phases_, Phase::continuity);
    advance_density(particles_, neighbours_, constants_, whole, 0);
  }
  {
    const Timer timer(phases_, Phase::integration);
    for_each(particles_.water, [&](std::size_t i, int) {
      Record& record = particles_.record[i];
      const Record& start = start_[i];
      record.s += start.s;
      record.p = pressure_of(record.s, constants_);
      for (int c = 0; c < 3; ++c) {
        record.v[c] = start.v[c];
        record.x[c] = start.x[c] + whole * (start.v[c] + half * acceleration_[i][c]);
      }
    });
    std::copy(start_.begin() + static_cast<std::ptrdiff_t>(particles_.water), start_.end(),
              particles_.record.begin() + static_cast<std::ptrdiff_t>(particles_.water));
  }
  move_walls(whole);
  integrate_velocities();
}

}  // namespace embacle::mps
