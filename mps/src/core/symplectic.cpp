// The other time step of Simulation: the thesis' symplectic integrator.
#include <algorithm>

#include "core/simulation.hpp"

namespace embacle::mps {

/// `integrator = "symplectic"` (thesis eq 5.22-5.27, with a = Gamma/rho0, which they miswrite, and unit weights):
///   r', v', s' = r + dt/2 v, v + dt/2 a(r, v, s), s + dt/2 ds/dt(r, v, s)
///   v += dt a(r', v', s');  r = r' + dt/2 v;  s = s' + dt/2 ds/dt(r, v, s')
/// A step leaves positions, velocities and densities of the same time, and nothing else.
void Simulation::step_symplectic() {
  const double whole = constants_.step, half = 0.5 * whole;
  // Lists must hold until mid-step. They are built at the start, so that the order of the particles stays.
  const auto remember_start = [&] {
    start_.assign(particles_.record.begin(), particles_.record.begin() + static_cast<std::ptrdiff_t>(particles_.own()));
  };
  remember_start();
  move(half);
  synchronise();
  std::copy(start_.begin(), start_.end(), particles_.record.begin());
  if (lists_valid_) {
    const Timer timer(phases_, Phase::halo);
    halo_.update_motion(particles_);
  } else {
    renew_lists(time_);
    remember_start();
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
    });
  }
  {
    const Timer timer(phases_, Phase::halo);
    halo_.update_motion(particles_);
  }

  evaluate_forces(time_ + half);
  {
    const Timer timer(phases_, Phase::integration);
    for_each(particles_.water, [&](std::size_t i, int) { std::copy_n(start_[i].v, 3, particles_.record[i].v); });
  }
  integrate_velocities();
  move(half);
  if (walls_.any_moves()) {  // over the whole step at once: two halves would leave them where no displacement is
    for (std::size_t j = particles_.water; j < particles_.own(); ++j)
      std::copy_n(start_[j].x, 3, particles_.record[j].x);
    move_walls(whole);
  }
  {
    const Timer timer(phases_, Phase::halo);
    halo_.update_motion(particles_);
  }
  const Timer timer(phases_, Phase::continuity);
  advance_density(particles_, neighbours_, constants_, half, 0);
}

}  // namespace embacle::mps
