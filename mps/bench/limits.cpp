#include "limits.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "core/simd.hpp"

namespace embacle::mps::bench {

namespace {

template <class Work>
double best_seconds(int repetitions, const Work& work) {
  double best = 1e300;
  for (int k = 0; k < repetitions; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

}  // namespace

double peak_flops() {
  constexpr int chains = 12, turns = 2'000'000;  // more chains than latency times throughput
  double sink = 0;
  const double seconds = best_seconds(5, [&] {
    Pack value[chains];
    for (int c = 0; c < chains; ++c) value[c] = splat(1 + c);
    Pack factor = splat(1 - 1e-9), term = splat(1e-9);
    asm volatile("" : "+x"(factor), "+x"(term));
    for (int t = 0; t < turns; ++t) {
#pragma GCC unroll 12
      for (Pack& v : value) v = v * factor + term;
    }
    for (const Pack& v : value) sink += horizontal_sum(v);
  });
  asm volatile("" : "+x"(sink));
  return 2.0 * lanes * chains * turns / seconds;
}

double triad_bandwidth() {
  constexpr std::size_t n = 16'000'000;  // 3 x 128 MB
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  double factor = 3;
  const double seconds = best_seconds(5, [&] {
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + factor * c[i];
    asm volatile("" : : "r"(a.data()) : "memory");
  });
  return 24.0 * n / seconds;
}

}  // namespace embacle::mps::bench
