#include "core/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace embacle::mps {

namespace {

/// Cells of half the radius: 5 x 5 rows of cells a particle; the rows are contiguous in memory.
constexpr int cells_per_radius = 2;

void pad(std::vector<std::uint32_t>& list, std::uint32_t sentinel) {
  while (list.size() % lanes != 0) list.push_back(sentinel);
}

}  // namespace

void Neighbours::make_grid(const Particles& particles) {
  // The grid spans the water and its surroundings only: solid points far from any water are not binned.
  double lower[3] = {1e300, 1e300, 1e300};
  double upper[3] = {-1e300, -1e300, -1e300};
  const auto extend = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      for (int c = 0; c < 3; ++c) {
        lower[c] = std::min(lower[c], particles.record[i].x[c]);
        upper[c] = std::max(upper[c], particles.record[i].x[c]);
      }
    }
  };
  extend(0, particles.water);
  extend(particles.ghosts_begin(), particles.ghost_solid_begin());
  for (int c = 0; c < 3; ++c) {
    if (!(lower[c] <= upper[c])) lower[c] = upper[c] = 0;
    const double margin = radius_ * 1.001;
    origin_[c] = lower[c] - margin;
    cell_[c] = radius_ / cells_per_radius;
    cells_[c] = c < dimension_ ? static_cast<int>((upper[c] - lower[c] + 2 * margin) / cell_[c]) + 1 : 1;
    if (c >= dimension_) cell_[c] = 1e30;
  }
  // A stray particle far away must not blow up the grid.
  const double limit = 64.0 * static_cast<double>(particles.all() + 64);
  while (static_cast<double>(cells_[0]) * cells_[1] * cells_[2] > limit) {
    for (int c = 0; c < dimension_; ++c) {
      cell_[c] *= 2;
      cells_[c] = (cells_[c] + 1) / 2;
    }
  }
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

void Neighbours::fill(Bins& bins, const Particles& particles, bool water, const std::vector<char>* only) {
  const std::size_t total = static_cast<std::size_t>(cells_[0]) * cells_[1] * cells_[2];
  std::vector<std::uint32_t> cells, source;
  bins.first.assign(total + 1, 0);
  const auto bin = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::int64_t cell = cell_of(particles.record[i].x);
      if (cell < 0 || (only != nullptr && (*only)[cell] == 0)) continue;
      cells.push_back(static_cast<std::uint32_t>(cell));
      source.push_back(static_cast<std::uint32_t>(i));
      ++bins.first[cell + 1];
    }
  };
  if (water) {
    bin(0, particles.water);
    bin(particles.ghosts_begin(), particles.ghost_solid_begin());
  } else {
    bin(particles.water, particles.own());
    bin(particles.ghost_solid_begin(), particles.all());
  }
  std::partial_sum(bins.first.begin(), bins.first.end(), bins.first.begin());
  std::vector<std::uint32_t> next(bins.first.begin(), bins.first.end() - 1);
  const std::size_t n = source.size();
  bins.x.resize(n);
  bins.y.resize(n);
  bins.z.resize(n);
  bins.index.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t slot = next[cells[k]]++;
    const Record& record = particles.record[source[k]];
    bins.x[slot] = record.x[0];
    bins.y[slot] = record.x[1];
    bins.z[slot] = record.x[2];
    bins.index[slot] = source[k];
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

void Neighbours::search(const Bins& bins, const double* x, std::vector<std::uint32_t>& list) const {
  int low[3], high[3];
  for (int c = 0; c < 3; ++c) {
    low[c] = std::max(0, static_cast<int>(std::floor((x[c] - radius_ - origin_[c]) / cell_[c])));
    high[c] = std::min(cells_[c] - 1, static_cast<int>(std::floor((x[c] + radius_ - origin_[c]) / cell_[c])));
  }
  if (low[0] > high[0]) return;
  const double square = radius_ * radius_;
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const std::size_t row = (static_cast<std::size_t>(k) * cells_[1] + j) * cells_[0];
      const std::uint32_t first = bins.first[row + low[0]];
      const std::uint32_t last = bins.first[row + high[0] + 1];
      if (first == last) continue;
      const std::size_t old = list.size();
      list.resize(old + (last - first));
      std::uint32_t* out = list.data() + old;
      for (std::uint32_t m = first; m < last; ++m) {
        const double dx = bins.x[m] - x[0];
        const double dy = bins.y[m] - x[1];
        const double dz = bins.z[m] - x[2];
        *out = bins.index[m];
        out += dx * dx + dy * dy + dz * dz < square ? 1 : 0;
      }
      list.resize(static_cast<std::size_t>(out - list.data()));
    }
  }
}

void Neighbours::build(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin) {
  make_grid(particles);
  // Most solid points are far from any water, and much of the water is far from solids: marked cells tell.
  fill(water_, particles, true);
  mark_surroundings(water_, near_water_);
  fill(solid_, particles, false, &near_water_);
  mark_surroundings(solid_, near_solid_);
  const std::uint32_t sentinel = particles.sentinel();

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
    search(water_, x, list);
    std::erase(list, static_cast<std::uint32_t>(i));
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
    if (near_solid_[cell_of(x)] != 0) search(solid_, x, list);
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
    const std::int64_t cell = cell_of(x);
    if (cell < 0 || near_water_[cell] == 0) continue;
    list.clear();
    search(water_, x, list);
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
  const std::uint64_t nx = static_cast<std::uint64_t>((upper[0] - lower[0]) / cell) + 1;
  const std::uint64_t ny = static_cast<std::uint64_t>((upper[1] - lower[1]) / cell) + 1;
  std::vector<std::uint64_t> key(travellers.size());
  for (std::size_t i = 0; i < travellers.size(); ++i) {
    const double* x = travellers[i].record.x;
    const auto at = [&](int c) { return static_cast<std::uint64_t>((x[c] - lower[c]) / cell); };
    key[i] = (at(2) * ny + at(1)) * nx + at(0);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return key[a] != key[b] ? key[a] < key[b] : travellers[a].identity.id < travellers[b].identity.id;
  });
  return order;
}

}  // namespace embacle::mps
