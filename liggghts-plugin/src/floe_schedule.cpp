#include "floe_schedule.hpp"

#include <algorithm>

namespace embacle::liggghts {

FloeSchedule::FloeSchedule(const FloeList& list) : repeat_(list.repeat) {
  for (std::size_t i = 0; i < list.floes.size(); ++i) {
    if (list.floes[i].enters) order_.push_back(i);
  }
  std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return *list.floes[i].enters; });
  for (const std::size_t i : order_) times_.push_back(*list.floes[i].enters);
}

double FloeSchedule::time_of(std::int64_t entry) const {
  const auto n = static_cast<std::int64_t>(order_.size());
  const std::int64_t cycle = entry / n;
  return times_[entry % n] + static_cast<double>(cycle) * repeat_;
}

std::size_t FloeSchedule::floe(std::int64_t entry) const {
  return order_[entry % static_cast<std::int64_t>(order_.size())];
}

const std::vector<std::int64_t>& FloeSchedule::due(double time) {
  const auto n = static_cast<std::int64_t>(order_.size());
  while (n > 0 && (repeat_ > 0 || next_ < n) && time_of(next_) <= time) waiting_.push_back(next_++);
  return waiting_;
}

void FloeSchedule::entered(std::int64_t entry) { std::erase(waiting_, entry); }

std::vector<double> FloeSchedule::save() const {
  std::vector<double> numbers{static_cast<double>(next_)};
  for (const std::int64_t entry : waiting_) numbers.push_back(static_cast<double>(entry));
  return numbers;
}

void FloeSchedule::restore(const std::vector<double>& numbers) {
  next_ = static_cast<std::int64_t>(numbers.front());
  waiting_.clear();
  for (std::size_t k = 1; k < numbers.size(); ++k) waiting_.push_back(static_cast<std::int64_t>(numbers[k]));
}

}  // namespace embacle::liggghts
