#include "core/structures.hpp"

namespace embacle::mps {

using coupling::Load;
using coupling::Vec3;

Structures::Structures(const Scene& scene) : slot_(scene.walls.size(), -1) {
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    if (!scene.walls[w].forces) continue;
    slot_[w] = static_cast<int>(impulses_.size());
    impulses_.emplace_back();
  }
}

void Structures::add(const Particles& particles, const std::vector<Triple>& reaction, const std::vector<Load>& guard,
                     double step) {
  time_ += step;
  for (std::size_t j = particles.water; j < particles.all(); ++j) {
    const auto owner = static_cast<std::size_t>(particles.identity[j].owner);
    if (particles.is_water(j) || owner >= slot_.size() || slot_[owner] < 0) continue;
    const Triple& f = reaction[reaction_slot(particles, j)];
    const double* x = particles.record[j].x;
    const Vec3 impulse = step * Vec3(f[0], f[1], f[2]);
    impulses_[slot_[owner]] += {impulse, Vec3(x[0], x[1], x[2]).cross(impulse)};
  }
  for (std::size_t w = 0; w < guard.size(); ++w) {
    if (slot_[w] >= 0) impulses_[slot_[w]] += {step * guard[w].force, step * guard[w].torque};
  }
}

std::vector<Load> Structures::take_means(MPI_Comm comm) {
  std::vector<double> sums;
  for (Load& load : impulses_) {
    sums.insert(sums.end(), load.force.begin(), load.force.end());
    sums.insert(sums.end(), load.torque.begin(), load.torque.end());
    load = {};
  }
  std::vector<double> total(sums.size());
  MPI_Reduce(sums.data(), total.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, 0, comm);
  std::vector<Load> means(impulses_.size());
  for (std::size_t k = 0; k < means.size() && time_ > 0; ++k) {
    const double* part = &total[6 * k];
    means[k] = {Vec3(part[0], part[1], part[2]) / time_, Vec3(part[3], part[4], part[5]) / time_};
  }
  time_ = 0;
  return means;
}

}  // namespace embacle::mps
