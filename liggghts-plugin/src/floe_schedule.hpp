// When the bodies of a file with a column of times appear. No LIGGGHTS here.
#pragma once

#include <cstdint>
#include <vector>

#include "floe_list.hpp"

namespace embacle::liggghts {

/// The entries of a list of floes in the order of their times, over and over if it repeats. What could not enter waits.
class FloeSchedule {
 public:
  FloeSchedule() = default;
  explicit FloeSchedule(const FloeList& list);

  [[nodiscard]] bool empty() const { return order_.empty(); }
  /// Numbers of the entries whose time has come and that have not entered, the oldest first.
  const std::vector<std::int64_t>& due(double time);
  /// The floe of an entry: an index into the list.
  [[nodiscard]] std::size_t floe(std::int64_t entry) const;
  void entered(std::int64_t entry);
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }

  [[nodiscard]] std::vector<double> save() const;
  void restore(const std::vector<double>& numbers);

 private:
  [[nodiscard]] double time_of(std::int64_t entry) const;

  std::vector<std::size_t> order_;  ///< of the list's floes that appear later, by time
  std::vector<double> times_;       ///< [s], of those
  double repeat_ = 0;               ///< [s]; 0: once
  std::int64_t next_ = 0;           ///< the first entry that was not yet due
  std::vector<std::int64_t> waiting_;
};

}  // namespace embacle::liggghts
