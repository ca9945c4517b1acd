// Symmetric matrices of the particle sums: whether they can be inverted, and their inverse.
#pragma once

#include <utility>

namespace embacle::mps {

/// A symmetric matrix: xx, yy, zz, xy, yz, zx.
using Symmetric = double[6];

/// Whether all eigenvalues of a matrix of a dimension are larger than `bound`.
inline bool all_eigenvalues_above(const Symmetric& m, double bound, int dimension) {
  const double a = m[0] - bound, b = m[1] - bound, c = m[2] - bound;
  const double minor = a * b - m[3] * m[3];
  if (!(a > 0 && minor > 0)) return false;
  if (dimension == 2) return true;
  return c * minor - a * m[4] * m[4] - b * m[5] * m[5] + 2 * m[3] * m[4] * m[5] > 0;
}

/// Inverts in place; in 2-D the third direction is left alone.
inline void invert(Symmetric& m, int dimension) {
  if (dimension == 2) {
    const double scale = 1 / (m[0] * m[1] - m[3] * m[3]);
    std::swap(m[0], m[1]);
    m[0] *= scale;
    m[1] *= scale;
    m[3] *= -scale;
    m[2] = 1;
    m[4] = m[5] = 0;
    return;
  }
  const Symmetric cofactor{m[1] * m[2] - m[4] * m[4], m[0] * m[2] - m[5] * m[5], m[0] * m[1] - m[3] * m[3],
                           m[4] * m[5] - m[3] * m[2], m[3] * m[5] - m[0] * m[4], m[3] * m[4] - m[1] * m[5]};
  const double scale = 1 / (m[0] * cofactor[0] + m[3] * cofactor[3] + m[5] * cofactor[5]);
  for (int k = 0; k < 6; ++k) m[k] = scale * cofactor[k];
}

}  // namespace embacle::mps
