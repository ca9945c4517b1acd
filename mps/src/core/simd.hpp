// Four doubles at a time, through the compiler's vector extension; no hardware gathers (slow on the CPUs measured).
#pragma once

#include <cmath>
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace embacle::mps {

inline constexpr int lanes = 4;
using Pack = double __attribute__((vector_size(32)));

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
  const Pack ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Pack ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Pack cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Pack cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

}  // namespace embacle::mps
