#include "core/displacements.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace embacle::mps {

namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();

}  // namespace

void Displacements::remember(const Particles& particles) {
  const std::size_t n = particles.all();
  double upper[3];
  std::fill_n(origin_, 3, 1e300);
  std::fill_n(upper, 3, -1e300);
  for (std::size_t i = 0; i < n; ++i) {
    for (int c = 0; c < 3; ++c) {
      origin_[c] = std::min(origin_[c], particles.record[i].x[c]);
      upper[c] = std::max(upper[c], particles.record[i].x[c]);
    }
  }
  double extent = 0;
  double block = block_;
  for (int c = 0; c < 3; ++c) extent = std::max(extent, upper[c] - origin_[c]);
  const auto count = [&](int c) { return n > 0 ? std::floor((upper[c] - origin_[c]) / block) + 1 : 1.0; };
  while (count(0) * count(1) * count(2) > 8.0 * static_cast<double>(n + 8)) block *= 2;  // strays far away
  for (int c = 0; c < 3; ++c) blocks_[c] = static_cast<int>(count(c));
  limit_ = static_cast<float>(skin_ - 4 * std::numeric_limits<float>::epsilon() * extent);
  per_block_ = static_cast<float>(1 / block);
  resize(place_, n);
  for (std::size_t i = 0; i < n; ++i) {
    for (int c = 0; c < 3; ++c) place_[i][c] = static_cast<float>(particles.record[i].x[c] - origin_[c]);
  }
}

std::size_t Displacements::block_of(const std::array<float, 3>& place) const {
  std::size_t index = 0;
  for (int c = 2; c >= 0; --c) {
    const int block = std::min(static_cast<int>(place[c] * per_block_), blocks_[c] - 1);
    index = index * blocks_[c] + static_cast<std::size_t>(block);
  }
  return index;
}

/// Extends each block's span by those of its two neighbours along an axis.
void Displacements::widen_along(int axis) {
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? blocks_[0] : static_cast<std::size_t>(blocks_[0]) * blocks_[1];
  widened_ = span_;
  for (std::size_t b = 0; b < span_.size(); ++b) {
    const auto place = static_cast<int>(b / stride % static_cast<std::size_t>(blocks_[axis]));
    const auto join = [&](const Span& other) {
      for (int c = 0; c < 3; ++c) {
        widened_[b].low[c] = std::min(widened_[b].low[c], other.low[c]);
        widened_[b].high[c] = std::max(widened_[b].high[c], other.high[c]);
      }
    };
    if (place > 0) join(span_[b - stride]);
    if (place + 1 < blocks_[axis]) join(span_[b + stride]);
  }
  span_.swap(widened_);
}

bool Displacements::lists_hold(const Particles& particles) {
  const std::size_t n = particles.all();
  const Span empty{{nothing, nothing, nothing}, {-nothing, -nothing, -nothing}};
  span_.assign(static_cast<std::size_t>(blocks_[0]) * blocks_[1] * blocks_[2], empty);
  float largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    Span& span = span_[block_of(place_[i])];
    float square = 0;
    for (int c = 0; c < 3; ++c) {
      const float moved = static_cast<float>(particles.record[i].x[c] - origin_[c]) - place_[i][c];
      square += moved * moved;
      span.low[c] = std::min(span.low[c], moved);
      span.high[c] = std::max(span.high[c], moved);
    }
    largest = std::max(largest, square);
  }
  if (!(largest <= limit_ * limit_)) return false;
  if (largest <= 0.25F * limit_ * limit_) return true;
  for (int axis = 0; axis < 3; ++axis) widen_along(axis);
  return std::all_of(span_.begin(), span_.end(), [&](const Span& span) {
    float square = 0;
    for (int c = 0; c < 3; ++c)
      square += span.high[c] > span.low[c] ? (span.high[c] - span.low[c]) * (span.high[c] - span.low[c]) : 0;
    return square <= limit_ * limit_;
  });
}

std::size_t Displacements::bytes() const {
  return place_.capacity() * sizeof(place_[0]) + (span_.capacity() + widened_.capacity()) * sizeof(Span);
}

}  // namespace embacle::mps
