#include "core/neighbours.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace embacle::mps {

namespace {

/// Cells of half the radius: 5 x 5 rows of cells a particle; the rows are contiguous in memory.
constexpr int cells_per_radius = 2;

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

void pad(std::vector<std::uint32_t>& list, std::uint32_t sentinel) {
  while (list.size() % lanes != 0) list.push_back(sentinel);
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
    origin_[c] = lower[c] - margin;
    extent = std::max(extent, upper[c] - lower[c] + 2 * margin);
    cell_[c] = radius_ / cells_per_radius;
    cells_[c] = c < dimension_ ? static_cast<int>((upper[c] - lower[c] + 2 * margin) / cell_[c]) + 1 : 1;
    if (c >= dimension_) cell_[c] = 1e30;
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
  cells_of_points_.resize(count);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::int64_t cell = cell_of(place(k));
    cells_of_points_[k] = cell < 0 ? nowhere : static_cast<std::uint32_t>(cell);
    if (cell < 0) continue;
    ++bins.first[cell + 1];
    ++kept;
  }
  std::partial_sum(bins.first.begin(), bins.first.end(), bins.first.begin());
  next_.assign(bins.first.begin(), bins.first.end() - 1);
  for (auto* column : {&bins.x, &bins.y, &bins.z}) column->resize(kept + search_lanes);  // the search reads full packs
  bins.index.resize(kept + search_lanes);
  for (std::size_t k = 0; k < count; ++k) {
    if (cells_of_points_[k] == nowhere) continue;
    const std::uint32_t slot = next_[cells_of_points_[k]]++;
    const double* x = place(k);
    bins.x[slot] = static_cast<float>(x[0] - origin_[0]);
    bins.y[slot] = static_cast<float>(x[1] - origin_[1]);
    bins.z[slot] = static_cast<float>(x[2] - origin_[2]);
    bins.index[slot] = index(k);
  }
}

void Neighbours::mark_surroundings(const Bins& bins, std::vector<char>& marks) const {
  const std::size_t total = static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2];
  marks.assign(total, 0);
  for (int k = 0; k < cells_[2]; ++k) {
    for (int j = 0; j < cells_[1]; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0];
      for (int i = 0; i < cells_[0]; ++i) {
        if (bins.first[row + i] == bins.first[row + i + 1]) continue;
        const int low = std::max(0, i - cells_per_radius), high = std::min(cells_[0] - 1, i + cells_per_radius);
        for (int kk = std::max(0, k - cells_per_radius); kk <= std::min(cells_[2] - 1, k + cells_per_radius); ++kk) {
          for (int jj = std::max(0, j - cells_per_radius); jj <= std::min(cells_[1] - 1, j + cells_per_radius); ++jj) {
            const std::size_t first = (static_cast<std::size_t>(kk) * cells_[1] + jj) * cells_[0];
            std::fill(marks.begin() + first + low, marks.begin() + first + high + 1, char{1});
          }
        }
      }
    }
  }
}

void Neighbours::search(const Bins& bins, const double* place, std::uint32_t self,
                        std::vector<std::uint32_t>& list) const {
  int low[3], high[3];
  float x[3];
  for (int c = 0; c < 3; ++c) {
    const double at = place[c] - origin_[c];
    x[c] = static_cast<float>(at);
    low[c] = std::max(0, static_cast<int>(std::floor((at - radius_) / cell_[c])));
    high[c] = std::min(cells_[c] - 1, static_cast<int>(std::floor((at + radius_) / cell_[c])));
  }
  if (low[0] > high[0]) return;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0];
      const std::uint32_t first = bins.first[row + low[0]];
      const std::uint32_t last = bins.first[row + high[0] + 1];
      if (first == last) continue;
      const std::size_t old = list.size();
      list.resize(old + (last - first) + search_lanes);
      std::uint32_t* out = list.data() + old;
      for (std::uint32_t m = first; m < last; m += search_lanes) {
        out = keep_close(&bins.x[m], &bins.y[m], &bins.z[m], &bins.index[m], std::min(search_lanes, last - m), x,
                         reach_square_, self, out);
      }
      list.resize(static_cast<std::size_t>(out - list.data()));
    }
  }
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
  const std::uint32_t sentinel = particles.sentinel();
  constexpr auto nobody = std::numeric_limits<std::uint32_t>::max();

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
  const auto thin_of = [&](std::uint32_t j) -> const ThinWall* {
    const Identity& identity = particles.identity[j];
    if (identity.owner < 0 || identity.owner >= walls.count() || walls.thin_index(identity.owner) < 0) return nullptr;
    return &thin[walls.thin_index(identity.owner)];
  };
  index_.clear();
  begin_.assign(1, 0);
  middle_.clear();
  std::vector<std::uint32_t> list;
  for (std::size_t i = 0; i < particles.water; ++i) {
    const double* x = particles.record[i].x;
    const bool sided = !thin.empty() && near_thin(x);
    list.clear();
    search(water_, x, static_cast<std::uint32_t>(i), list);
    if (sided) {
      std::erase_if(list, [&](std::uint32_t j) {
        return std::any_of(thin.begin(), thin.end(), [&](const ThinWall& wall) {
          return Walls::separates(wall, x, particles.record[j].x, dimension_);
        });
      });
    }
    pad(list, sentinel);
    index_.insert(index_.end(), list.begin(), list.end());
    middle_.push_back(index_.size());
    list.clear();
    if (near_solid_[cell_of(x)] != 0) search(solid_, x, nobody, list);
    if (sided && !list.empty()) {
      std::erase_if(list, [&](std::uint32_t j) {
        const ThinWall* wall = thin_of(j);
        return wall != nullptr && !Walls::visible(*wall, particles.identity[j].point, x);
      });
    }
    pad(list, sentinel);
    index_.insert(index_.end(), list.begin(), list.end());
    begin_.push_back(index_.size());
  }

  wet_points_.clear();
  wet_index_.clear();
  wet_begin_.assign(1, 0);
  for (std::size_t b = particles.water; b < particles.own(); ++b) {
    const double* x = particles.record[b].x;
    if (!near_water(x)) continue;
    list.clear();
    search(water_, x, nobody, list);
    if (const ThinWall* wall = thin_of(static_cast<std::uint32_t>(b))) {
      std::erase_if(list, [&](std::uint32_t i) {
        return !Walls::visible(*wall, particles.identity[b].point, particles.record[i].x);
      });
    }
    if (list.empty()) continue;
    pad(list, sentinel);
    wet_points_.push_back(static_cast<std::uint32_t>(b));
    wet_index_.insert(wet_index_.end(), list.begin(), list.end());
    wet_begin_.push_back(wet_index_.size());
  }
}

std::size_t Neighbours::bytes() const {
  return sizeof(std::uint32_t) * (index_.capacity() + wet_index_.capacity() + wet_points_.capacity()) +
         sizeof(std::size_t) * (begin_.capacity() + middle_.capacity() + wet_begin_.capacity());
}

std::vector<std::uint32_t> Neighbours::cell_order(const std::vector<Traveller>& travellers, double cell) {
  std::vector<std::uint32_t> order(travellers.size());
  std::iota(order.begin(), order.end(), 0U);
  if (travellers.empty()) return order;
  double lower[3] = {1e300, 1e300, 1e300}, upper[3] = {-1e300, -1e300, -1e300};
  for (const Traveller& traveller : travellers) {
    for (int c = 0; c < 3; ++c) {
      lower[c] = std::min(lower[c], traveller.record.x[c]);
      upper[c] = std::max(upper[c], traveller.record.x[c]);
    }
  }
  const auto cells = [&](int c) { return static_cast<std::size_t>((upper[c] - lower[c]) / cell) + 1; };
  const std::size_t nx = cells(0), ny = cells(1), nz = cells(2);
  std::vector<std::size_t> key(travellers.size());
  for (std::size_t i = 0; i < travellers.size(); ++i) {
    const double* x = travellers[i].record.x;
    const auto at = [&](int c) { return static_cast<std::size_t>((x[c] - lower[c]) / cell); };
    key[i] = (at(2) * ny + at(1)) * nx + at(0);
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
