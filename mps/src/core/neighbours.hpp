// Neighbour lists with a skin, built from cells, valid until something has moved by half the skin.
#pragma once

#include <cstdint>
#include <vector>

#include "core/particles.hpp"
#include "core/threads.hpp"
#include "core/walls.hpp"

namespace embacle::mps {

/// Neighbours of a particle: indices into the particles' records, padded to full packs with the sentinel.
struct NeighbourRange {
  PackedIndices::Iterator begin;
  PackedIndices::Iterator middle;  ///< water in [begin, middle), solid points in [middle, end)
  PackedIndices::Iterator end;
};

/// Some of the own water, or of the wet points: those whose lists hold no ghost of another rank, and the others.
class Subset {
 public:
  /// The first `n`, all of them.
  explicit Subset(std::size_t n) : size_(n) {}
  explicit Subset(const std::vector<std::uint32_t>& members) : members_(members.data()), size_(members.size()) {}
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t operator[](std::size_t k) const { return members_ != nullptr ? members_[k] : k; }

 private:
  const std::uint32_t* members_ = nullptr;
  std::size_t size_;
};
enum class Part { all, inner, rim };

class Neighbours {
 public:
  /// `radius` [m]: support plus skin.
  Neighbours(int dimension, double radius) : dimension_(dimension), radius_(radius) {}

  /// First part of a new search: bins the water, own and ghosts, and marks where solids can matter.
  void survey(const Particles& particles, const std::vector<Traveller>& ghost_water);
  /// Whether water may lie within the radius of a place, as surveyed.
  [[nodiscard]] bool near_water(const double* x) const {
    const std::int64_t cell = cell_of(x);
    return cell >= 0 && near_water_[cell] != 0;
  }
  /// Second part, with all particles in place: lists of all own water particles (water and solid neighbours) and of all
  /// own solid points (water only). `thin`: the thin walls at their present place (see Walls).
  void build(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin);

  [[nodiscard]] NeighbourRange of_water(std::size_t i) const {
    const auto first = index_[thread_[i]].begin() + lanes * std::ptrdiff_t{begin_[i]};
    return {first, first + water_count_[i], first + count_[i]};
  }
  /// Own solid points that have water near, as indices into the records, and their water.
  [[nodiscard]] const std::vector<std::uint32_t>& wet_points() const { return wet_points_; }
  [[nodiscard]] NeighbourRange of_wet_point(std::size_t k) const {
    const auto end = wet_index_.begin() + lanes * std::ptrdiff_t{wet_begin_[k + 1]};
    return {wet_index_.begin() + lanes * std::ptrdiff_t{wet_begin_[k]}, end, end};
  }
  /// Of the own water, or of the wet points by their number: all, those with no ghost in their lists, the others.
  [[nodiscard]] Subset water(Part part) const { return subset(part, begin_.size(), water_parts_); }
  [[nodiscard]] Subset wet(Part part) const { return subset(part, wet_points_.size(), wet_parts_); }
  /// Directed pairs in all lists, padding included.
  [[nodiscard]] std::size_t pairs() const;
  [[nodiscard]] std::size_t bytes() const;

  /// Order of own water by cell (for sorting before the next build).
  [[nodiscard]] std::vector<std::uint32_t> cell_order(const std::vector<Traveller>& travellers) const;

 private:
  /// Points binned into cells, contiguous along x. Places relative to the grid's origin, in single precision: the
  /// radius of the search is widened by what that can lose.
  struct Bins {
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> index;
    std::vector<std::uint32_t> first;  ///< of each cell
  };
  template <class Place>
  void make_grid(std::size_t count, const Place& place);
  /// Cell of a place, or -1 outside the grid.
  [[nodiscard]] std::int64_t cell_of(const double* x) const;
  [[nodiscard]] std::size_t cell_index(const int* cell) const {
    return (static_cast<std::size_t>(cell[2]) * cells_[1] + cell[1]) * cells_[0] + cell[0];
  }
  /// Bins `count` points; `place(k)` is a point's place, `index(k)` its index. Points outside the grid are left out.
  template <class Place, class Index>
  void fill(Bins& bins, std::size_t count, const Place& place, const Index& index);
  /// Marks all cells within the radius of an occupied one.
  void mark_surroundings(const Bins& bins, std::vector<char>& marks) const;
  /// What the bins hold in the cells around one cell.
  struct Surroundings {
    std::vector<float> x, y, z;
    std::vector<std::uint32_t> index;
    std::uint32_t count = 0;
  };
  void gather(const Bins& bins, const int* cell, Surroundings& around) const;
  /// Writes the indices of the surroundings within the radius of a place, but for `self`, and returns their number.
  std::size_t select(const Surroundings& around, const double* x, std::uint32_t self,
                     std::vector<std::uint32_t>& list) const;
  /// Number of entries to expect in the lists of the points with an index below `own`, of what `around` holds: from
  /// those of every so many cells. Padding included.
  [[nodiscard]] std::size_t expected_entries(const Particles& particles, const Bins& bins, const Bins& around,
                                             std::size_t own) const;
  /// Calls `visit(cell, first, last)` for every cell in which the bins hold something: its coordinates, its range.
  /// Of all cells, or of one thread's share of them: consecutive cells with its share of the points.
  template <class Visit>
  void for_occupied_cells(const Bins& bins, const Visit& visit, int thread = 0, int of_threads = 1) const;
  void list_water(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin, int thread);
  /// Of one thread, to be joined.
  struct WetLists {
    std::vector<std::uint32_t> points;
    PackedIndices index;
    std::vector<std::uint32_t> packs;  ///< number of each list
  };
  void list_wet_points(const Particles& particles, const Walls& walls, const std::vector<ThinWall>& thin, int thread,
                       WetLists& lists) const;
  void join_wet_points(std::vector<WetLists>& parts);
  struct Parts {
    std::vector<std::uint32_t> inner, rim;
  };
  /// Without ghosts there is no rim, and nothing is stored.
  [[nodiscard]] Subset subset(Part part, std::size_t n, const Parts& parts) const {
    if (part == Part::all || (!ghosts_ && part == Part::inner)) return Subset(n);
    return Subset(part == Part::inner ? parts.inner : parts.rim);
  }
  void divide(const Particles& particles);

  /// Cells within the radius along x, y, z. Long rows, contiguous in memory along x, cost least: 9 of them around a
  /// cell.
  static constexpr int cells_per_radius[3] = {2, 1, 1};

  int dimension_;
  double radius_;
  double cell_[3] = {1, 1, 1};
  double origin_[3] = {0, 0, 0};
  int cells_[3] = {1, 1, 1};
  float reach_square_ = 0;  ///< square of the radius, widened
  Bins water_, solid_;
  std::vector<std::uint32_t> slot_, next_;     ///< scratch
  std::vector<char> near_water_, near_solid_;  ///< per cell
  std::vector<PackedIndices> index_;           ///< of the own water, as each thread has listed it
  std::vector<std::uint8_t> thread_;           ///< which listed it
  PackedIndices wet_index_;
  std::vector<std::uint32_t> begin_, wet_begin_;    ///< first pack of each list
  std::vector<std::uint16_t> water_count_, count_;  ///< with padding, of the list of each own water particle
  std::vector<std::uint32_t> wet_points_;
  bool ghosts_ = false;
  Parts water_parts_, wet_parts_;
};

}  // namespace embacle::mps
