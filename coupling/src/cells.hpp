// Places sorted into cells, to find those near another place.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

class Cells {
 public:
  /// `edge` [m]: every place within this distance is found.
  explicit Cells(double edge) : edge_(edge) {}

  /// Places are numbered in the order in which they are added.
  void add(const Vec3& place) { cells_[cell_of(place)].push_back(count_++); }

  /// Visits the numbers of the places in the cell of a place and its neighbours.
  template <typename Visit>
  void visit(const Vec3& place, Visit&& visit_one) const {
    const std::array<int, 3> centre = cell_of(place);
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        for (int k = -1; k <= 1; ++k) {
          const auto cell = cells_.find({centre[0] + i, centre[1] + j, centre[2] + k});
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

  double edge_;
  std::size_t count_ = 0;
  std::map<std::array<int, 3>, std::vector<std::size_t>> cells_;
};

}  // namespace embacle::coupling
