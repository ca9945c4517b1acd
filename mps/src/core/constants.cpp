#include "core/constants.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "embacle/coupling/types.hpp"

namespace embacle::mps {

namespace {

/// Largest speed [m/s] of a corner of a wall by its turn.
double turning_speed(const Wall& wall, int dimension) {
  double rate = std::abs(wall.motion->angular_velocity);
  const auto& table = wall.motion->angle_table;
  for (std::size_t k = 1; k < table.size(); ++k) {
    rate = std::max(rate, std::abs((table[k].second - table[k - 1].second) / (table[k].first - table[k - 1].first)));
  }
  double arm = 0;
  for (int corner = 0; corner < (1 << dimension); ++corner) {
    double along = 0, square = 0;
    for (int c = 0; c < dimension; ++c) {
      const double x = (corner >> c) % 2 == 1 ? wall.region.upper[c] : wall.region.lower[c];
      along += (x - wall.motion->pivot[c]) * wall.motion->axis[c];
      square += (x - wall.motion->pivot[c]) * (x - wall.motion->pivot[c]);
    }
    arm = std::max(arm, std::sqrt(std::max(0.0, square - along * along)));
  }
  return rate * arm;
}

/// Of a corner of the water at the start from the centre of the central force [m].
double farthest_from_centre(const Scene& scene) {
  double farthest = 0;
  for (const Water& water : scene.water) {
    double square = 0;
    for (int c = 0; c < scene.dimension; ++c) {
      const double centre = scene.fluid.central_force_centre[c];
      square +=
          std::pow(std::max(std::abs(water.region.lower[c] - centre), std::abs(water.region.upper[c] - centre)), 2);
    }
    farthest = std::max(farthest, std::sqrt(square));
  }
  return farthest;
}

}  // namespace

double reference_speed(const Scene& scene) {
  if (scene.numerics.reference_speed > 0) return scene.numerics.reference_speed;
  const Vec3d weight = scene.static_gravity();
  double gravity = 0;
  for (const double g : weight) gravity += g * g;
  gravity = std::sqrt(gravity);
  double lowest = 1e300, highest = -1e300, fastest = 0;
  for (const Water& water : scene.water) {
    double low = 0, high = 0, speed = 0;
    for (int c = 0; c < 3; ++c) {
      const double up = gravity > 0 ? -weight[c] / gravity : 0;
      low += std::min(up * water.region.lower[c], up * water.region.upper[c]);
      high += std::max(up * water.region.lower[c], up * water.region.upper[c]);
      speed += water.velocity[c] * water.velocity[c];
    }
    lowest = std::min(lowest, low);
    highest = std::max(highest, high);
    fastest = std::max(fastest, std::sqrt(speed));
    for (const WaterTable::Row& row : water.table.rows) {
      const Vec3d& v = row.velocity;
      fastest = std::max(fastest, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
  }
  for (const Wall& wall : scene.walls) {
    // Water falls as far as the floor of its tank.
    if (wall.kind == Wall::Kind::tank && gravity > 0 && highest > lowest) {
      double floor = 0;
      for (int c = 0; c < 3; ++c) {
        const double up = -scene.fluid.gravity[c] / gravity;
        floor += std::min(up * wall.region.lower[c], up * wall.region.upper[c]);
      }
      lowest = std::min(lowest, floor);
    }
    if (!wall.motion) continue;
    double speed = 0;
    for (const double v : wall.motion->velocity) speed += v * v;
    for (const double v : wall.motion->surface_velocity) speed += v * v;
    fastest = std::max(fastest, std::sqrt(speed));
    for (std::size_t k = 1; k < wall.motion->table.size(); ++k) {
      const auto& [t0, d0] = wall.motion->table[k - 1];
      const auto& [t1, d1] = wall.motion->table[k];
      double square = 0;
      for (int c = 0; c < 3; ++c) square += (d1[c] - d0[c]) * (d1[c] - d0[c]);
      fastest = std::max(fastest, std::sqrt(square) / (t1 - t0));
    }
    fastest = std::max(fastest, turning_speed(wall, scene.dimension));
  }
  fastest = std::max(fastest, std::sqrt(scene.fluid.central_force) * farthest_from_centre(scene));
  const double head = highest > lowest ? std::sqrt(2 * gravity * (highest - lowest)) : 0;
  const double result = std::max(head, fastest);
  if (result > 0) return result;
  throw coupling::InputError(scene.file.string() +
                             ": numerics.reference_speed: cannot be derived (no head of water, no motion); state it");
}

std::pair<double, StepLimit> longest_step(const Constants& c, const Motions& motions) {
  const double l0 = c.particle_distance;
  std::pair<double, StepLimit> longest{c.cfl * l0 / (c.sound_speed + motions.water), StepLimit::acoustic};
  const auto limit = [&](double step, StepLimit by) {
    if (step < longest.first) longest = {step, by};
  };
  if (c.viscosity > 0) limit(0.125 * l0 * l0 / c.viscosity, StepLimit::viscous);
  if (motions.acceleration > 0) limit(0.25 * std::sqrt(l0 / motions.acceleration), StepLimit::force);
  limit(c.cfl * l0 / (c.sound_speed + motions.bodies), StepLimit::bodies);
  return longest;
}

Constants constants_of(const Scene& scene) {
  Constants c;
  c.dimension = scene.dimension;
  c.particle_distance = scene.numerics.particle_distance;
  c.kernel = scene.numerics.kernel;
  c.support = c.particle_distance *
              (scene.numerics.support > 0 ? scene.numerics.support : default_support(scene.numerics.kernel));
  c.skin = scene.numerics.skin * c.particle_distance;
  c.layers = static_cast<int>(std::floor(c.support / c.particle_distance + 1e-9));
  c.density = scene.fluid.density;
  c.particle_mass = c.density * std::pow(c.particle_distance, c.dimension) * (c.dimension == 2 ? scene.thickness : 1.0);
  for (int k = 0; k < 3; ++k) c.gravity[k] = scene.fluid.gravity[k];
  for (int k = 0; k < 3; ++k) c.static_gravity[k] = scene.static_gravity()[k];
  if (scene.numerics.diffusion == Diffusion::dynamic) std::copy_n(c.static_gravity, 3, c.diffusion_gravity);
  c.central_force = scene.fluid.central_force;
  for (int k = 0; k < 3; ++k) c.centre[k] = scene.fluid.central_force_centre[k];
  c.periodic = periodic_of(scene);
  c.reference_speed = reference_speed(scene);
  c.sound_speed = scene.numerics.sound_speed > 0 ? scene.numerics.sound_speed : 10 * c.reference_speed;
  c.viscosity = scene.fluid.kinematic_viscosity;
  c.wall_friction = c.viscosity > 0 && std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& wall) {
                      return wall.slip || (wall.motion && wall.motion->surface_velocity != Vec3d{});
                    });
  c.cfl = scene.numerics.cfl;
  const double weight =
      std::sqrt(c.gravity[0] * c.gravity[0] + c.gravity[1] * c.gravity[1] + c.gravity[2] * c.gravity[2]);
  const double central = c.central_force > 0 ? c.central_force * farthest_from_centre(scene) : 0;
  std::tie(c.step, c.step_limit) = longest_step(c, {c.reference_speed, 0, weight + central});
  c.lattice = c.kernel == KernelKind::wendland
                  ? lattice_sums<KernelKind::wendland>(c.dimension, c.particle_distance, c.support)
                  : lattice_sums<KernelKind::rational>(c.dimension, c.particle_distance, c.support);
  c.gradient_factor = c.dimension / c.lattice.weight;
  c.laplacian_factor = 2.0 * c.dimension / c.lattice.weight_square;
  c.artificial_viscosity = scene.numerics.artificial_viscosity * c.sound_speed * c.particle_distance;
  c.density_diffusion = scene.numerics.diffusion_coefficient() * c.sound_speed * c.particle_distance;
  c.plain_operators = scene.numerics.regularisation == Regularisation::plain_shifting;
  c.shifting = scene.numerics.shifting;
  c.crowding_factor =
      c.dimension / lattice_sums<KernelKind::rational>(c.dimension, c.particle_distance, c.support).weight;
  if (scene.numerics.regularisation != Regularisation::none)
    c.collision_distance = scene.numerics.collision_distance * c.particle_distance;
  if (scene.numerics.turbulence == TurbulenceModel::smagorinsky) c.smagorinsky = scene.numerics.smagorinsky;
  c.collision_restitution = scene.numerics.collision_restitution;
  return c;
}

}  // namespace embacle::mps
