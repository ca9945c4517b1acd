#include "core/friction.hpp"

#include <algorithm>

namespace embacle::mps {

namespace {

/// Water nearer to the surface than this, in particle distances, counts as that far: the factor stays bounded.
constexpr double least_distance = 0.25;

}  // namespace

Friction::Friction(const Scene& scene, const Constants& constants, const Walls& walls)
    : constants_(constants), walls_(walls) {
  for (const Wall& wall : scene.walls) {
    const bool belt = wall.motion && wall.motion->surface_velocity != Vec3d{};
    contact_.push_back(wall.slip.value_or(false)       ? Contact::slips
                       : wall.slip.has_value() || belt ? Contact::sticks
                                                       : Contact::mirrored);
  }
}

void Friction::apply(const Particles& particles, const Neighbours& neighbours, double time,
                     std::vector<Triple>& acceleration, Reactions& reaction) const {
  if (!constants_.wall_friction) return;
  if (constants_.kernel == KernelKind::wendland) {
    add<KernelKind::wendland>(particles, neighbours, time, acceleration, reaction);
  } else {
    add<KernelKind::rational>(particles, neighbours, time, acceleration, reaction);
  }
}

template <KernelKind K>
void Friction::add(const Particles& particles, const Neighbours& neighbours, double time,
                   std::vector<Triple>& acceleration, Reactions& reaction) const {
  const Kernel<K> kernel{1.0 / constants_.support};
  const double viscous_factor = constants_.viscosity * constants_.laplacian_factor;
  const double least = least_distance * constants_.particle_distance;
  std::vector<Pose> pose(walls_.count());
  std::vector<Vec3d> surface(walls_.count());
  for (int w = 0; w < walls_.count(); ++w) {
    const auto& motion = walls_.definition(w).motion;
    if (!motion) continue;
    pose[w] = walls_.course(w).pose(time);
    if (time >= motion->start && time <= motion->stop) surface[w] = motion->surface_velocity;
  }
  for_each(particles.water, [&](std::size_t i, int thread) {
    Triple* const on_points = reaction.of_thread(thread);
    const NeighbourRange range = neighbours.of_water(i);
    const Record& me = particles.record[i];
    for (auto k = range.middle; k < range.end && *k != particles.sentinel(); ++k) {
      const Record& other = particles.record[*k];
      const Identity& identity = particles.identity[*k];
      double square = 0;
      for (int c = 0; c < constants_.dimension; ++c) square += (other.x[c] - me.x[c]) * (other.x[c] - me.x[c]);
      const double distance = std::sqrt(square);
      if (distance >= constants_.support) continue;
      double share = 2;
      Vec3d velocity{other.v[0], other.v[1], other.v[2]};
      if (identity.owner < walls_.count()) {
        const int w = identity.owner;
        if (contact_[w] == Contact::slips) continue;
        for (int c = 0; c < 3; ++c) velocity[c] += surface[w][c];
        if (contact_[w] == Contact::sticks) {
          const Walls::Distances d = walls_.distances(w, identity.point, pose[w], other.x, me.x, constants_.periodic);
          share = 1 + std::max(0.0, d.point) / std::max(least, d.water);
        }
      }
      const double factor = viscous_factor * share * kernel.gradient_weight(distance) * square;
      const std::size_t slot = reaction_slot(particles, *k);
      for (int c = 0; c < constants_.dimension; ++c) {
        const double value = factor * (velocity[c] - me.v[c]);
        acceleration[i][c] += value;
        on_points[slot][c] -= constants_.particle_mass * value;
      }
    }
  });
}

}  // namespace embacle::mps
