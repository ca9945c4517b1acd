#include "core/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "embacle/coupling/types.hpp"

namespace embacle::mps {

namespace {

/// Points compared at a time by the search.
constexpr std::uint32_t search_lanes = 8;

#ifdef __AVX2__
/// For each 8-bit mask the lanes it keeps, in order.
struct Compression {
  alignas(32) std::uint32_t lane[256][8] = {};
  constexpr Compression() {
    for (int mask = 0; mask < 256; ++mask) {
      int kept = 0;
      for (std::uint32_t bit = 0; bit < 8; ++bit) {
        if ((mask >> bit & 1) != 0) lane[mask][kept++] = bit;
      }
    }
  }
};
constexpr Compression compression;
#endif

/// Copies n values in full packs: a short loop beats memmove, and both sides have room.
template <class Value>
void copy_packs(const Value* from, std::uint32_t n, Value* to) {
  for (std::uint32_t m = 0; m < n; m += search_lanes) std::memcpy(to + m, from + m, search_lanes * sizeof(Value));
}

/// Of up to eight points, writes the indices of those that are closer to `place` than the radius, but for `self`, and
/// returns the new end. Reads and writes full packs.
inline std::uint32_t* keep_close(const float* x, const float* y, const float* z, const std::uint32_t* index,
                                 std::uint32_t count, const float* place, float square, std::uint32_t self,
                                 std::uint32_t* out) {
#ifdef __AVX2__
  const __m256 dx = _mm256_sub_ps(_mm256_loadu_ps(x), _mm256_set1_ps(place[0]));
  const __m256 dy = _mm256_sub_ps(_mm256_loadu_ps(y), _mm256_set1_ps(place[1]));
  const __m256 dz = _mm256_sub_ps(_mm256_loadu_ps(z), _mm256_set1_ps(place[2]));
  const __m256 r2 = _mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_add_ps(_mm256_mul_ps(dy, dy), _mm256_mul_ps(dz, dz)));
  const __m256i who = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(index));
  const __m256i same = _mm256_cmpeq_epi32(who, _mm256_set1_epi32(static_cast<int>(self)));
  const __m256 close = _mm256_cmp_ps(r2, _mm256_set1_ps(square), _CMP_LT_OQ);
  const auto mask = static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_andnot_ps(_mm256_castsi256_ps(same), close))) &
                    ((1U << count) - 1U);
  const __m256i order = _mm256_load_si256(reinterpret_cast<const __m256i*>(compression.lane[mask]));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_permutevar8x32_epi32(who, order));
  return out + std::popcount(mask);
#else
  for (std::uint32_t m = 0; m < count; ++m) {
    const float dx = x[m] - place[0], dy = y[m] - place[1], dz = z[m] - place[2];
    *out = index[m];
    out += dx * dx + dy * dy + dz * dz < square && index[m] != self ? 1 : 0;
  }
  return out;
#endif
}

std::uint16_t count_of(std::size_t n) {
  if (n > std::numeric_limits<std::uint16_t>::max()) {
    throw coupling::InstabilityError("a water particle has more than 65 535 neighbours: the water has collapsed");
  }
  return static_cast<std::uint16_t>(n);
}

}  // namespace

// The grid spans the water and its surroundings only: solid points far from any water are not binned.
template <class Place>
void Neighbours::make_grid(std::size_t count, const Place& place) {
  double lower[3] = {1e300, 1e300, 1e300};
  double upper[3] = {-1e300, -1e300, -1e300};
  for (std::size_t k = 0; k < count; ++k) {
    const double* x = place(k);
    for (int c = 0; c < 3; ++c) {
      lower[c] = std::min(lower[c], x[c]);
      upper[c] = std::max(upper[c], x[c]);
    }
  }
  double extent = 0;
  for (int c = 0; c < 3; ++c) {
    if (!(lower[c] <= upper[c])) lower[c] = upper[c] = 0;
    const double margin = radius_ * 1.001;
    cell_[c] = radius_ / cells_per_radius[c];
    origin_[c] = cell_[c] * std::floor((lower[c] - margin) / cell_[c]);  // as in cell_order()
    extent = std::max(extent, upper[c] - origin_[c] + margin);
    cells_[c] = c < dimension_ ? static_cast<int>((upper[c] + margin - origin_[c]) / cell_[c]) + 1 : 1;
    if (c >= dimension_) {
      cell_[c] = 1e30;
      origin_[c] = lower[c];
    }
  }
  // A stray particle far away must not blow up the grid.
  const double limit = 64.0 * static_cast<double>(count + 64);
  while (static_cast<double>(cells_[0]) * cells_[1] * cells_[2] > limit) {
    for (int c = 0; c < dimension_; ++c) {
      cell_[c] *= 2;
      cells_[c] = (cells_[c] + 1) / 2;
    }
  }
  const double widened = radius_ * (1 + 1e-6) + 4 * std::numeric_limits<float>::epsilon() * extent;
  reach_square_ = static_cast<float>(widened * widened);
}

std::int64_t Neighbours::cell_of(const double* x) const {
  std::int64_t cell = 0;
  for (int c = 2; c >= 0; --c) {
    const double place = (x[c] - origin_[c]) / cell_[c];
    if (!(place >= 0 && place < cells_[c])) return -1;
    cell = cell * cells_[c] + static_cast<std::int64_t>(place);
  }
  return cell;
}

template <class Place, class Index>
void Neighbours::fill(Bins& bins, std::size_t count, const Place& place, const Index& index) {
  const std::size_t total = static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2];
  constexpr auto nowhere = std::numeric_limits<std::uint32_t>::max();
  bins.first.assign(total + 1, 0);
  slot_.resize(count);
  for_each(count, [&](std::size_t k, int) {
    const std::int64_t cell = cell_of(place(k));
    slot_[k] = cell < 0 ? nowhere : static_cast<std::uint32_t>(cell);
  });
  for (const std::uint32_t cell : slot_) {
    if (cell != nowhere) ++bins.first[cell + 1];
  }
  std::partial_sum(bins.first.begin(), bins.first.end(), bins.first.begin());
  next_.assign(bins.first.begin(), bins.first.end() - 1);
  for (std::uint32_t& slot : slot_) {
    if (slot != nowhere) slot = next_[slot]++;
  }
  const std::size_t kept = bins.first.back();
  for (auto* column : {&bins.x, &bins.y, &bins.z}) column->resize(kept + search_lanes);  // the search reads full packs
  bins.index.resize(kept + search_lanes);
  for_each(count, [&](std::size_t k, int) {
    const std::uint32_t slot = slot_[k];
    if (slot == nowhere) return;
    const double* x = place(k);
    bins.x[slot] = static_cast<float>(x[0] - origin_[0]);
    bins.y[slot] = static_cast<float>(x[1] - origin_[1]);
    bins.z[slot] = static_cast<float>(x[2] - origin_[2]);
    bins.index[slot] = index(k);
  });
}

void Neighbours::mark_surroundings(const Bins& bins, std::vector<char>& marks) const {
  const std::size_t total = static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2];
  marks.assign(total, 0);
  for (int k = 0; k < cells_[2]; ++k) {
    for (int j = 0; j < cells_[1]; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0];
      for (int i = 0; i < cells_[0]; ++i) {
        if (bins.first[row + i] == bins.first[row + i + 1]) continue;
        const int low = std::max(0, i - cells_per_radius[0]), high = std::min(cells_[0] - 1, i + cells_per_radius[0]);
        for (int kk = std::max(0, k - cells_per_radius[2]); kk <= std::min(cells_[2] - 1, k + cells_per_radius[2]);
             ++kk) {
          for (int jj = std::max(0, j - cells_per_radius[1]); jj <= std::min(cells_[1] - 1, j + cells_per_radius[1]);
               ++jj) {
            const std::size_t first = (static_cast<std::size_t>(kk) * cells_[1] + jj) * cells_[0];
            std::fill(marks.begin() + first + low, marks.begin() + first + high + 1, char{1});
          }
        }
      }
    }
  }
}

void Neighbours::gather(const Bins& bins, const int* cell, Surroundings& around) const {
  int low[3], high[3];
  for (int c = 0; c < 3; ++c) {
    low[c] = std::max(0, cell[c] - cells_per_radius[c]);
    high[c] = std::min(cells_[c] - 1, cell[c] + cells_per_radius[c]);
  }
  around.count = 0;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0];
      const std::uint32_t first = bins.first[row + low[0]];
      const std::uint32_t n = bins.first[row + high[0] + 1] - first;
      if (n == 0) continue;
      if (around.count + n + 2 * search_lanes > around.x.size()) {
        const std::size_t size = 2 * (around.count + n + search_lanes);
        for (auto* column : {&around.x, &around.y, &around.z}) column->resize(size);
        around.index.resize(size);
      }
      copy_packs(&bins.x[first], n, &around.x[around.count]);
      copy_packs(&bins.y[first], n, &around.y[around.count]);
      copy_packs(&bins.z[first], n, &around.z[around.count]);
      copy_packs(&bins.index[first], n, &around.index[around.count]);
      around.count += n;
    }
  }
}

std::size_t Neighbours::select(const Surroundings& around, const double* place, std::uint32_t self,
                               std::vector<std::uint32_t>& list) const {
  float x[3];
  for (int c = 0; c < 3; ++c) x[c] = static_cast<float>(place[c] - origin_[c]);
  if (list.size() < around.count + search_lanes) list.resize(around.count + search_lanes);
  std::uint32_t* out = list.data();
  for (std::uint32_t m = 0; m < around.count; m += search_lanes) {
    out = keep_close(&around.x[m], &around.y[m], &around.z[m], &around.index[m],
                     std::min(search_lanes, around.count - m), x, reach_square_, self, out);
  }
  return static_cast<std::size_t>(out - list.data());
}

template <class Visit>
void Neighbours::for_occupied_cells(const Bins& bins, const Visit& visit, int thread, int of_threads) const {
  const std::uint32_t points = bins.first.back();
  const auto share = [&](int t) {
    const auto point = static_cast<std::uint32_t>(std::uint64_t{points} * t / of_threads);
    return static_cast<std::size_t>(std::lower_bound(bins.first.begin(), bins.first.end(), point) - bins.first.begin());
  };
  const std::size_t end = thread + 1 == of_threads ? bins.first.size() - 1 : share(thread + 1);
  for (std::size_t index = thread == 0 ? 0 : share(thread); index < end; ++index) {
    if (bins.first[index] == bins.first[index + 1]) continue;
    const std::size_t row = index / cells_[0];
    const int cell[3] = {static_cast<int>(index % cells_[0]), static_cast<int>(row % cells_[1]),
                         static_cast<int>(row / cells_[1])};
    visit(cell, bins.first[index], bins.first[index + 1]);
  }
}

std::size_t Neighbours::expected_entries(const Particles& particles, const Bins& bins, const Bins& around,
                                         std::size_t own) const {
  constexpr int every = 17;
  Surroundings found;
  std::vector<std::uint32_t> list;
  std::size_t entries = 0, points = 0, sampled = 0, cells = 0;
  for_occupied_cells(bins, [&](const int* cell, std::uint32_t first, std::uint32_t last) {
    points += last - first;
    if (cells++ % every != 0) return;
    sampled += last - first;
    gather(around, cell, found);
    for (std::uint32_t m = first; m < last; ++m) {
      if (bins.index[m] >= own) continue;
      const std::size_t n = select(found, particles.record[bins.index[m]].x, bins.index[m], list);
      entries += (n + lanes - 1) / lanes * lanes;
    }
  });
  if (sampled == 0) return 0;
  return static_cast<std::size_t>(static_cast<double>(entries) * static_cast<double>(points) /
                                  static_cast<double>(sampled));
}

void Neighbours::survey(const Particles& particles, const std::vector<Traveller>& ghost_water) {
  const std::size_t own = particles.water;
  const auto place = [&](std::size_t k) { return k < own ? particles.record[k].x : ghost_water[k - own].record.x; };
  make_grid(own + ghost_water.size(), place);
  // Ghosts stand behind the own solid points, whose number is not known yet: build() completes their index.
  fill(water_, own + ghost_water.size(), place, [](std::size_t k) { return static_cast<std::uint32_t>(k); });
  mark_surroundings(water_, near_water_);
}

void Neighbours::build(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin) {
  if (particles.sentinel() > PackedIndices::largest) {
    throw coupling::InputError(
        fmt::format("a rank has {} particles, with its walls and ghosts; at most {} are possible: "
                    "use more ranks (--fluid-ranks)",
                    particles.all(), PackedIndices::largest));
  }
  for (std::uint32_t& index : water_.index) {
    if (index >= particles.water) index += static_cast<std::uint32_t>(particles.solid);
  }
  const auto solid_index = [&](std::size_t k) {
    return static_cast<std::uint32_t>(k < particles.solid ? particles.water + k
                                                          : particles.ghost_solid_begin() + (k - particles.solid));
  };
  fill(
      solid_, particles.solid + particles.ghost_solid,
      [&](std::size_t k) { return particles.record[solid_index(k)].x; }, solid_index);
  mark_surroundings(solid_, near_solid_);
  // The lists are most of a rank's memory: as much as they will need, not twice that.
  const auto parts = static_cast<std::size_t>(threads());
  if (index_.size() != parts) {
    const std::size_t expected = expected_entries(particles, water_, water_, particles.water) +
                                 expected_entries(particles, water_, solid_, particles.water);
    index_.assign(parts, {});
    for (auto& part : index_) part.reserve(expected / parts);
    if (parts == 1) wet_index_.reserve(expected_entries(particles, solid_, water_, particles.own()));
  }
  resize(begin_, particles.water);
  resize(thread_, particles.water);
  resize(water_count_, particles.water);
  resize(count_, particles.water);
  std::vector<WetLists> wet(parts);
  if (parts == 1) wet.front().index.swap(wet_index_);
  in_every_thread([&](int thread) {
    list_water(particles, walls, thin, thread);
    list_wet_points(particles, walls, thin, thread, wet[thread]);
  });
  join_wet_points(wet);
  divide(particles);
}

/// Tells what needs ghosts from what does not, for work while an exchange is on its way.
void Neighbours::divide(const Particles& particles) {
  ghosts_ = particles.ghost_water + particles.ghost_solid > 0;
  for (Parts* parts : {&water_parts_, &wet_parts_}) {
    parts->inner.clear();
    parts->rim.clear();
  }
  if (!ghosts_) return;
  const auto first = static_cast<std::uint32_t>(particles.own()), end = particles.sentinel();
  const auto add = [&](Parts& parts, std::uint32_t k, const NeighbourRange& range) {
    const bool rim = std::any_of(range.begin, range.end, [&](std::uint32_t j) { return j >= first && j < end; });
    (rim ? parts.rim : parts.inner).push_back(k);
  };
  for (std::uint32_t i = 0; i < particles.water; ++i) add(water_parts_, i, of_water(i));
  for (std::uint32_t k = 0; k < wet_points_.size(); ++k) add(wet_parts_, k, of_wet_point(k));
}

namespace {

/// The thin wall to which a solid point belongs, or none.
const ThinWall* thin_of(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin,
                        std::uint32_t j) {
  const Identity& identity = particles.identity[j];
  if (identity.owner < 0 || identity.owner >= walls.count() || walls.thin_index(identity.owner) < 0) return nullptr;
  return &thin[walls.thin_index(identity.owner)];
}

/// Appends the first `n` entries of `list` but those that are `hidden`, and pads; returns how many these are.
template <class Hidden>
std::size_t append(PackedIndices& lists, std::vector<std::uint32_t>& list, std::size_t n, std::uint32_t sentinel,
                   const Hidden& hidden) {
  n = static_cast<std::size_t>(std::remove_if(list.begin(), list.begin() + n, hidden) - list.begin());
  lists.append(list.data(), n, lanes, sentinel);
  return n;
}

constexpr auto nobody = std::numeric_limits<std::uint32_t>::max();

}  // namespace

/// The lists of one thread's share of the own water.
void Neighbours::list_water(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin,
                            int thread) {
  // Thin walls near a place: only there do sides matter.
  const double near = 2 * radius_;
  const auto near_thin = [&](const double* x) {
    return std::any_of(thin.begin(), thin.end(), [&](const ThinWall& wall) {
      for (int c = 0; c < dimension_; ++c) {
        if (x[c] < wall.lower[c] - near || x[c] > wall.upper[c] + near) return false;
      }
      return true;
    });
  };
  const auto nothing = [](std::uint32_t) { return false; };
  const std::uint32_t sentinel = particles.sentinel();
  Surroundings water_around, solid_around;
  std::vector<std::uint32_t> list;
  PackedIndices& lists = index_[thread];
  lists.clear();
  const auto list_cell = [&](const int* cell, std::uint32_t first, std::uint32_t last) {
    if (std::none_of(&water_.index[first], &water_.index[last], [&](auto i) { return i < particles.water; })) return;
    gather(water_, cell, water_around);
    const bool solids = near_solid_[cell_index(cell)] != 0;
    if (solids) gather(solid_, cell, solid_around);
    for (std::uint32_t m = first; m < last; ++m) {
      const std::uint32_t i = water_.index[m];
      if (i >= particles.water) continue;
      const double* x = particles.record[i].x;
      const bool sided = !thin.empty() && near_thin(x);
      const std::size_t begin = lists.size();
      begin_[i] = static_cast<std::uint32_t>(begin / lanes);
      thread_[i] = static_cast<std::uint8_t>(thread);
      std::size_t found = select(water_around, x, i, list);
      if (sided) {
        append(lists, list, found, sentinel, [&](std::uint32_t j) {
          return std::any_of(thin.begin(), thin.end(), [&](const ThinWall& wall) {
            return Walls::separates(wall, x, particles.record[j].x, dimension_);
          });
        });
      } else {
        append(lists, list, found, sentinel, nothing);
      }
      water_count_[i] = count_of(lists.size() - begin);
      if (solids) {
        found = select(solid_around, x, nobody, list);
        if (sided) {
          append(lists, list, found, sentinel, [&](std::uint32_t j) {
            const ThinWall* wall = thin_of(particles, walls, thin, j);
            return wall != nullptr && !Walls::visible(*wall, particles.identity[j].point, x);
          });
        } else {
          append(lists, list, found, sentinel, nothing);
        }
      }
      count_[i] = count_of(lists.size() - begin);
    }
  };
  for_occupied_cells(water_, list_cell, thread, threads());
  lists.make_room(lists.size());
}

/// Those of its share of the own solid points near water.
void Neighbours::list_wet_points(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin,
                                 int thread, WetLists& lists) const {
  Surroundings water_around;
  std::vector<std::uint32_t> list;
  lists.index.clear();
  const auto list_cell = [&](const int* cell, std::uint32_t first, std::uint32_t last) {
    if (near_water_[cell_index(cell)] == 0) return;
    gather(water_, cell, water_around);
    for (std::uint32_t m = first; m < last; ++m) {
      const std::uint32_t b = solid_.index[m];
      if (b >= particles.own()) continue;
      const std::size_t found = select(water_around, particles.record[b].x, nobody, list);
      const ThinWall* wall = thin_of(particles, walls, thin, b);
      const std::size_t before = lists.index.size();
      const std::size_t kept = append(lists.index, list, found, particles.sentinel(), [&](std::uint32_t i) {
        return wall != nullptr && !Walls::visible(*wall, particles.identity[b].point, particles.record[i].x);
      });
      if (kept == 0) continue;
      lists.points.push_back(b);
      lists.packs.push_back(static_cast<std::uint32_t>((lists.index.size() - before) / lanes));
    }
  };
  for_occupied_cells(solid_, list_cell, thread, threads());
}

void Neighbours::join_wet_points(std::vector<WetLists>& parts) {
  wet_points_.clear();
  wet_begin_.assign(1, 0);
  if (parts.size() == 1) {
    wet_index_.swap(parts.front().index);
  } else {
    wet_index_.clear();
    std::size_t entries = 0;
    for (const WetLists& part : parts) entries += part.index.size();
    wet_index_.make_room(entries);
    for (const WetLists& part : parts) wet_index_.append(part.index);
  }
  for (const WetLists& part : parts) {
    wet_points_.insert(wet_points_.end(), part.points.begin(), part.points.end());
    for (const std::uint32_t packs : part.packs) wet_begin_.push_back(wet_begin_.back() + packs);
  }
  wet_index_.make_room(wet_index_.size());
}

std::size_t Neighbours::pairs() const {
  std::size_t pairs = wet_index_.size();
  for (const auto& part : index_) pairs += part.size();
  return pairs;
}

std::size_t Neighbours::bytes() const {
  std::size_t lists = wet_index_.memory(), members = 0;
  for (const auto& part : index_) lists += part.memory();
  for (const Parts* parts : {&water_parts_, &wet_parts_}) members += parts->inner.capacity() + parts->rim.capacity();
  return lists +
         sizeof(std::uint32_t) * (members + wet_points_.capacity() + begin_.capacity() + wet_begin_.capacity()) +
         thread_.capacity() + sizeof(std::uint16_t) * (water_count_.capacity() + count_.capacity());
}

std::vector<std::uint32_t> Neighbours::cell_order(const std::vector<Traveller>& travellers) const {
  std::vector<std::uint32_t> order(travellers.size());
  std::iota(order.begin(), order.end(), 0U);
  if (travellers.empty()) return order;
  const auto at = [&](std::size_t i, int c) {
    return std::floor(travellers[i].record.x[c] * cells_per_radius[c] / radius_);
  };
  double lower[3] = {1e300, 1e300, 1e300}, upper[3] = {-1e300, -1e300, -1e300};
  for (std::size_t i = 0; i < travellers.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      lower[c] = std::min(lower[c], at(i, c));
      upper[c] = std::max(upper[c], at(i, c));
    }
  }
  const auto cells = [&](int c) { return static_cast<std::size_t>(upper[c] - lower[c]) + 1; };
  const std::size_t nx = cells(0), ny = cells(1), nz = cells(2);
  std::vector<std::size_t> key(travellers.size());
  for (std::size_t i = 0; i < travellers.size(); ++i) {
    const auto place = [&](int c) { return static_cast<std::size_t>(at(i, c) - lower[c]); };
    key[i] = (place(2) * ny + place(1)) * nx + place(0);
  }
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return key[a] != key[b] ? key[a] < key[b] : travellers[a].identity.id < travellers[b].identity.id;
  };
  if (nx * ny * nz > 64 * travellers.size()) {  // stray particles far away: too many cells to count in
    std::sort(order.begin(), order.end(), before);
    return order;
  }
  std::vector<std::uint32_t> first(nx * ny * nz + 1, 0);
  for (const std::size_t k : key) ++first[k + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  for (std::uint32_t i = 0; i < travellers.size(); ++i) order[first[key[i]]++] = i;
  for (auto begin = order.begin(); begin != order.end();) {  // within a cell by identity: the same on any rank count
    auto end = begin + 1;
    while (end != order.end() && key[*end] == key[*begin]) ++end;
    std::sort(begin, end, before);
    begin = end;
  }
  return order;
}

}  // namespace embacle::mps
