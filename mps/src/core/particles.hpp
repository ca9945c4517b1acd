// The particles of one rank: one 64-byte record each (what the pair loops read), and what identifies them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/packed_indices.hpp"
#include "core/room.hpp"
#include "core/simd.hpp"

namespace embacle::mps {

/// What a neighbour must know of a particle: exactly one cache line.
struct alignas(64) Record {
  double x[3] = {0, 0, 0};  ///< position [m]
  double v[3] = {0, 0, 0};  ///< velocity [m/s]
  double p = 0;             ///< pressure [Pa]
  double s = 1;             ///< n/n0 = rho/rho0 [-]
};

/// Four rows of eight doubles (a cache line each) as columns.
template <class Row>
std::array<Pack, 8> load_columns(const Row* rows, PackedIndices::Iterator index) {
  static_assert(sizeof(Row) == 8 * sizeof(double) && alignof(Row) == 64);
  std::array<Pack, 8> c;
  const std::array<std::size_t, 4> offset = index.four<sizeof(Row)>();
  const auto* first = reinterpret_cast<const unsigned char*>(rows);
  const auto row = [&](int lane, int half) { return *(reinterpret_cast<const Pack*>(first + offset[lane]) + half); };
  for (int half = 0; half < 2; ++half) {
    for (int lane = 0; lane < 4; ++lane) c[4 * half + lane] = row(lane, half);
    transpose(c[4 * half], c[4 * half + 1], c[4 * half + 2], c[4 * half + 3]);
  }
  return c;
}

/// Four records as columns.
struct RecordPack {
  Pack x, y, z, vx, vy, vz, p, s;
};

inline RecordPack load(const Record* records, PackedIndices::Iterator index) {
  const auto c = load_columns(records, index);
  return {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]};
}

/// Identity of a particle.
struct Identity {
  std::int64_t id = 0;  ///< unique over all ranks for water; walls likewise; body points: -1
  std::int32_t owner =
      -1;  ///< water: -1; walls: index of the wall; body points: number of walls + index of the body on this rank
  /// Body points: index into the shape's points; walls: side (see Wall sides); water: 1 + the opening that drives it,
  /// or 0.
  std::int32_t point = 0;
};

/// A particle as it travels between ranks.
struct Traveller {
  Record record;
  Identity identity;
};

/// All particles of a rank, in the order: own water, own solid points (walls, then bodies), ghost water, ghost solid
/// points, and one sentinel far away, to which padded neighbour lists point.
class Particles {
 public:
  std::vector<Record> record = std::vector<Record>(1);
  std::vector<Identity> identity = std::vector<Identity>(1);
  std::size_t water = 0;  ///< own water particles: [0, water)
  std::size_t solid = 0;  ///< own solid points: [water, water + solid)
  std::size_t ghost_water = 0;
  std::size_t ghost_solid = 0;

  [[nodiscard]] std::size_t own() const { return water + solid; }
  [[nodiscard]] std::size_t all() const { return water + solid + ghost_water + ghost_solid; }
  [[nodiscard]] std::uint32_t sentinel() const { return static_cast<std::uint32_t>(all()); }
  [[nodiscard]] std::size_t ghosts_begin() const { return own(); }
  [[nodiscard]] std::size_t ghost_solid_begin() const { return own() + ghost_water; }
  [[nodiscard]] bool is_water(std::size_t i) const { return i < water || (i >= own() && i < ghost_solid_begin()); }

  /// Replaces everything by this own water, in the given order; no solids, no ghosts.
  void assign(const std::vector<Traveller>& own_water, const std::vector<std::uint32_t>& order = {});
  /// Appends the solid points and the ghosts to own water.
  void append(const std::vector<Traveller>& own_solid, const std::vector<Traveller>& water_ghosts,
              const std::vector<Traveller>& solid_ghosts);

 private:
  void push(const std::vector<Traveller>& travellers);
  void put_sentinel();
};

inline void Particles::put_sentinel() {
  Record far;
  far.x[0] = far.x[1] = far.x[2] = 1e30;
  record.push_back(far);
  identity.emplace_back();
}

inline void Particles::push(const std::vector<Traveller>& travellers) {
  for (const Traveller& traveller : travellers) {
    record.push_back(traveller.record);
    identity.push_back(traveller.identity);
  }
}

inline void Particles::assign(const std::vector<Traveller>& own_water, const std::vector<std::uint32_t>& order) {
  record.clear();
  identity.clear();
  record.reserve(own_water.size() + 1);
  identity.reserve(own_water.size() + 1);
  if (order.empty()) {
    push(own_water);
  } else {
    for (const std::uint32_t i : order) {
      record.push_back(own_water[i].record);
      identity.push_back(own_water[i].identity);
    }
  }
  water = own_water.size();
  solid = ghost_water = ghost_solid = 0;
  put_sentinel();
}

inline void Particles::append(const std::vector<Traveller>& own_solid, const std::vector<Traveller>& water_ghosts,
                              const std::vector<Traveller>& solid_ghosts) {
  record.resize(water);
  identity.resize(water);
  const std::size_t total = water + own_solid.size() + water_ghosts.size() + solid_ghosts.size() + 1;
  make_room(record, total);
  make_room(identity, total);
  push(own_solid);
  push(water_ghosts);
  push(solid_ghosts);
  solid = own_solid.size();
  ghost_water = water_ghosts.size();
  ghost_solid = solid_ghosts.size();
  put_sentinel();
}

}  // namespace embacle::mps
