// Places sorted into cells, to find those near another place.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

class Cells {
 public:
  /// `edge` [m] of the cells.
  explicit Cells(double edge) : edge_(edge) {}

  /// Places are numbered in the order in which they are added.
  void add(const Vec3& place) { cells_[cell_of(place)].push_back(count_++); }

  /// Visits the numbers of the places in all cells within `reach` [m] of a place.
  template <typename Visit>
  void visit(const Vec3& place, double reach, Visit&& visit_one) const {
    const std::array<int, 3> low = cell_of(place - Vec3::Constant(reach)),
                             high = cell_of(place + Vec3::Constant(reach));
    for (int i = low[0]; i <= high[0]; ++i) {
      for (int j = low[1]; j <= high[1]; ++j) {
        for (int k = low[2]; k <= high[2]; ++k) {
          const auto cell = cells_.find({i, j, k});
          if (cell == cells_.end()) continue;
          for (const std::size_t number : cell->second) visit_one(number);
        }
      }
    }
  }

 private:
  [[nodiscard]] std::array<int, 3> cell_of(const Vec3& place) const {
    return {static_cast<int>(std::floor(place.x() / edge_)), static_cast<int>(std::floor(place.y() / edge_)),
            static_cast<int>(std::floor(place.z() / edge_))};
  }

  struct Hash {
    std::size_t operator()(const std::array<int, 3>& cell) const {
      std::uint64_t mixed = 0;
      for (const int index : cell) mixed = (mixed ^ static_cast<std::uint32_t>(index)) * 0x9E3779B97F4A7C15U;
      return mixed ^ (mixed >> 32U);
    }
  };
  double edge_;
  std::size_t count_ = 0;
  std::unordered_map<std::array<int, 3>, std::vector<std::size_t>, Hash> cells_;
};

}  // namespace embacle::coupling
