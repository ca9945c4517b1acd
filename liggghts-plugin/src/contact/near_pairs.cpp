#include "contact/near_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace embacle::liggghts {

using coupling::Vec3;

std::vector<std::pair<int, int>> near_pairs(const std::vector<Vec3>& centres, const std::vector<double>& radii,
                                            std::size_t first, double margin, const Vec3& period) {
  std::vector<std::pair<int, int>> pairs;
  if (centres.empty()) return pairs;
  const double cell = 2 * *std::max_element(radii.begin(), radii.end()) + margin;
  // In a periodic direction whole cells fill the period; fewer than three of them are one.
  std::array<std::int64_t, 3> count{};
  Vec3 edge = Vec3::Constant(cell);
  for (int k = 0; k < 3; ++k) {
    if (period[k] <= 0) continue;
    count[k] = std::max<std::int64_t>(1, static_cast<std::int64_t>(period[k] / cell));
    if (count[k] < 3) count[k] = 1;
    edge[k] = period[k] / static_cast<double>(count[k]);
  }
  using Cell = std::array<std::int64_t, 3>;
  const auto wrapped = [&](Cell at) {
    for (int k = 0; k < 3; ++k) {
      if (count[k] > 0) at[k] = (at[k] % count[k] + count[k]) % count[k];
    }
    return at;
  };
  const auto number = [](const Cell& at) {
    constexpr std::int64_t half = 1 << 20;
    return (at[0] + half) << 42 | (at[1] + half) << 21 | (at[2] + half);
  };
  std::unordered_map<std::int64_t, std::vector<int>> cells;
  std::vector<Cell> of(centres.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    for (int k = 0; k < 3; ++k) of[i][k] = static_cast<std::int64_t>(std::floor(centres[i][k] / edge[k]));
    of[i] = wrapped(of[i]);
    cells[number(of[i])].push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < std::min(first, centres.size()); ++i) {
    std::vector<std::int64_t> around;
    around.reserve(27);
    for (int n = 0; n < 27; ++n) {
      around.push_back(number(wrapped({of[i][0] + n % 3 - 1, of[i][1] + n / 3 % 3 - 1, of[i][2] + n / 9 - 1})));
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    const std::size_t begin = pairs.size();
    for (const std::int64_t at : around) {
      const auto found = cells.find(at);
      if (found == cells.end()) continue;
      for (const int j : found->second) {
        if (j <= static_cast<int>(i)) continue;
        Vec3 apart = centres[j] - centres[i];
        for (int k = 0; k < 3; ++k) {
          if (period[k] > 0) apart[k] -= period[k] * std::round(apart[k] / period[k]);
        }
        const double reach = radii[i] + radii[j] + margin;
        if (apart.squaredNorm() < reach * reach) pairs.emplace_back(static_cast<int>(i), j);
      }
    }
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(begin), pairs.end());
  }
  return pairs;
}

}  // namespace embacle::liggghts
