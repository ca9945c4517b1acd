// What the simulation does for bodies at its start and when a plan is new; their part of a step is in simulation.cpp.
#include <fmt/format.h>

#include <algorithm>

#include "core/filling.hpp"
#include "core/simulation.hpp"

namespace embacle::mps {

void Simulation::adopt_bodies() {
  const std::vector<coupling::Shape>& shapes = link_->solid().shapes;
  bodies_.emplace(constants_, shapes, walls_.count());
  if (scene_.coupling.loads == Loads::pressure) surface_loads_.emplace(constants_, *bodies_, walls_.count());
  LightBodies light(constants_, shapes, walls_.count(), predicts() ? longest_step_ : window_length());
  if (!light.any()) return;
  if (scene_.coupling.scheme == Scheme::serial) {
    bodies_->leave_accelerations_of(light.light());
    light_bodies_.emplace(std::move(light));
  } else {
    warnings_.push_back(fmt::format(
        "bodies are so light that the water's sound stops them {:.3g} times within a window; the parallel scheme "
        "applies "
        "loads a window late and is unstable from about 1 on: choose coupling.scheme = \"serial\", or shorter windows",
        light.largest_chi()));
  }
}

/// Bodies must be where the water's domain is: at the start the user's mistake, later a body that was thrown out.
void Simulation::check_bodies() const {
  for (const auto& body : bodies_->all()) {
    for (int c = 0; c < constants_.dimension; ++c) {
      const double x = body.state.position[c];
      if (x >= scene_.domain.lower[c] && x <= scene_.domain.upper[c]) continue;
      const std::string message = fmt::format(
          "body {} is at ({:.5g}, {:.5g}, {:.5g}) m, outside the water's domain (scene: domain.lower, domain.upper)",
          body.tag, body.state.position[0], body.state.position[1], body.state.position[2]);
      if (!started_) throw coupling::InputError(message);
      throw coupling::InstabilityError(fmt::format("step {}, t = {:.6g} s: {}", counters_.steps, time_, message));
    }
  }
}

void Simulation::remove_water_in_bodies(std::int64_t newer_than) {
  auto water = own_water();
  const auto before = water.size();
  const double clearance = 0.45 * constants_.particle_distance;
  std::erase_if(water, [&](Traveller& traveller) {
    double* const x = traveller.record.x;
    const double place[3] = {x[0], x[1], x[2]};
    if (!bodies_->make_room(x, newer_than)) return true;
    return !std::equal(x, x + 3, place) && near_wall(scene_, walls_, x, clearance);
  });
  std::int64_t removed = static_cast<std::int64_t>(before - water.size());
  MPI_Allreduce(MPI_IN_PLACE, &removed, 1, MPI_INT64_T, MPI_SUM, comm_);
  (started_ ? displaced_by_arrivals_ : removed_at_start_) += removed;
  particles_.assign(water);
  acceleration_.clear();
  lists_valid_ = false;
}

/// Tags are never used twice, and new ones are greater. The lists are made at once: what is recorded before the next
/// step reads them.
void Simulation::welcome_arrivals() {
  const std::int64_t known = newest_tag_;
  for (std::size_t b = 0; b < bodies_->count(); ++b) newest_tag_ = std::max(newest_tag_, bodies_->tag(b));
  MPI_Allreduce(MPI_IN_PLACE, &newest_tag_, 1, MPI_INT64_T, MPI_MAX, comm_);
  if (!started_ || newest_tag_ == known) return;
  remove_water_in_bodies(known);
  find_neighbours(time_);
}

}  // namespace embacle::mps
