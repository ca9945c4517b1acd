// Dimension and kernel as compile-time constants for the pair loops.
#pragma once

#include "core/constants.hpp"
#include "core/simd.hpp"

namespace embacle::mps {

/// Calls `run` with the dimension and the kernel as compile-time constants.
template <class Run>
void dispatch(const Constants& constants, Run&& run) {
  const auto with_kernel = [&]<int D>() {
    if (constants.kernel == KernelKind::wendland) {
      run.template operator()<D, KernelKind::wendland>();
    } else {
      run.template operator()<D, KernelKind::rational>();
    }
  };
  if (constants.dimension == 3) {
    with_kernel.template operator()<3>();
  } else {
    with_kernel.template operator()<2>();
  }
}

template <int D>
inline Pack dot(Pack ax, Pack ay, Pack az, Pack bx, Pack by, Pack bz) {
  if constexpr (D == 3) {
    return ax * bx + ay * by + az * bz;
  } else {
    return ax * bx + ay * by;
  }
}

}  // namespace embacle::mps
