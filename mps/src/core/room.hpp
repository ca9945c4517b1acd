// Vectors whose size changes little from build to build: room for a few per cent more, not for twice as many.
#pragma once

#include <algorithm>
#include <vector>

namespace embacle::mps {

/// Makes room for `n` values in all, with a 128th to spare, if there is none; gives back room when a quarter is unused.
template <class Value>
void make_room(std::vector<Value>& values, std::size_t n) {
  if (n > values.capacity()) {
    values.reserve(n + n / 128);
  } else if (values.capacity() - n > n / 3 + 1024) {
    std::vector<Value> smaller;
    smaller.reserve(n + n / 128);
    values.resize(std::min(values.size(), n));
    smaller.assign(values.begin(), values.end());
    values.swap(smaller);
  }
}

template <class Value>
void resize(std::vector<Value>& values, std::size_t n) {
  make_room(values, n);
  values.resize(n);
}

}  // namespace embacle::mps
