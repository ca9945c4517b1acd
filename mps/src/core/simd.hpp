// Four doubles at a time, through the compiler's vector extension; no hardware gathers (slow on the CPUs measured).
#pragma once

#include <cmath>
#include <cstdint>
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace embacle::mps {

inline constexpr int lanes = 4;
using Pack = double __attribute__((vector_size(32)));
using PackMask = std::int64_t __attribute__((vector_size(32)));

inline Pack splat(double value) { return Pack{value, value, value, value}; }

inline Pack square_root(Pack value) {
#ifdef __AVX__
  return static_cast<Pack>(_mm256_sqrt_pd(static_cast<__m256d>(value)));
#else
  return Pack{std::sqrt(value[0]), std::sqrt(value[1]), std::sqrt(value[2]), std::sqrt(value[3])};
#endif
}

inline Pack max_zero(Pack value) { return value > 0.0 ? value : splat(0.0); }

inline double horizontal_sum(Pack value) { return (value[0] + value[1]) + (value[2] + value[3]); }

/// Turns four rows into four columns.
inline void transpose(Pack& a, Pack& b, Pack& c, Pack& d) {
  const PackMask even{0, 4, 2, 6};
  const PackMask odd{1, 5, 3, 7};
  const PackMask low{0, 1, 4, 5};
  const PackMask high{2, 3, 6, 7};
  const Pack ab0 = __builtin_shuffle(a, b, even);
  const Pack ab1 = __builtin_shuffle(a, b, odd);
  const Pack cd0 = __builtin_shuffle(c, d, even);
  const Pack cd1 = __builtin_shuffle(c, d, odd);
  a = __builtin_shuffle(ab0, cd0, low);
  b = __builtin_shuffle(ab1, cd1, low);
  c = __builtin_shuffle(ab0, cd0, high);
  d = __builtin_shuffle(ab1, cd1, high);
}

}  // namespace embacle::mps
