// The initial particles of a scene.
#pragma once

#include <string>
#include <vector>

#include "core/constants.hpp"
#include "core/particles.hpp"
#include "core/walls.hpp"

namespace embacle::mps {

/// The particles with which one rank starts (any share of the whole; the decomposition sorts them out).
struct InitialParticles {
  std::vector<Traveller> water;
  std::vector<Traveller> walls;
  std::int64_t next_id = 0;  ///< of water, the same on every rank
  std::vector<std::string> warnings;
};

/// Fills boxes and other forms of water on lattices of the particle distance, or takes the particles of their tables,
/// less what lies in walls, with hydrostatic pressure below each region's level unless a table has pressures; and the
/// walls. Rank `rank` of `size` generates its share only. Throws InputError for pressures beyond the equation of state.
[[nodiscard]] InitialParticles fill(const Scene& scene, const Constants& constants, const Walls& walls, int rank,
                                    int size);
/// Whether a place is in a wall, beyond a closed side of a tank, or nearer to either than `clearance` [m], at time
/// zero.
[[nodiscard]] bool near_wall(const Scene& scene, const Walls& walls, const double* x, double clearance);
/// A rank's share of the walls' points, at time zero.
[[nodiscard]] std::vector<Traveller> wall_points_of(const Walls& walls, int rank, int size);

}  // namespace embacle::mps
