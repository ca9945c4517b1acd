// Corrected operators and particle shifting: what keeps internal flow accurate and its particles in order.
#pragma once

#include <vector>

#include "core/constants.hpp"
#include "core/halo.hpp"
#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "core/particles.hpp"

namespace embacle::mps {

/// What the corrected operators must know of a neighbour, beside its record: one more cache line.
struct alignas(64) Correction {
  double b[6] = {1, 1, 1, 0, 0, 0};  ///< xx, yy, zz, xy, yz, zx of B: the inverse of (d/n0) SUM F r r, or identity
  double laplacian = 0;              ///< SUM F r^4: lambda n0 of this particle's own neighbourhood [m^4]
  double interior = 0;               ///< 1 for water farther than the support from any free surface
};

/// Regularisation by shifting, with gradient and divergence corrected to first order.
///
/// The plain operators see a spurious divergence wherever the particles are out of order, and stop internal flow; with
///   B_i = [(d/n0) SUM F r r]^-1
/// in the interior (identity for solids, near the free surface, and where the smallest eigenvalue of the matrix is
/// below 0.5) linear fields are exact:
///   ds/dt = -(d/n0) SUM (v_j - v_i).B_i r F + diffusion + u.grad s
///   a_i   = -(d/(rho0 n0)) SUM (p_i B_j + p_j B_i) r F + viscosity + u.grad v + g
/// (the pair terms of pressure and viscosity are antisymmetric). Where p_i < 0 in the interior, B_i (p_j - p_i) stands
/// instead, which cannot pull particles into clumps (tensile control; Sun et al. 2018, doi:10.1016/j.cma.2018.01.014).
/// That and u.grad v are what linear momentum is not exact for. Particles are transported with v + u, u = -2 l0 U s
/// grad C, |u| <= U/2, with the concentration gradient of thesis eq 5.33 (C_i, C_j = 1), by the rational weight
/// whatever the kernel: that of `wendland` pushes least where particles are closest, and voids that open in shear are
/// taken for free surfaces. U is twice the largest relative speed within the support, at most the largest speed of all;
/// near the free surface only the part of u that does not lead out of the water (thesis eq 5.36; Jandaghian &
/// Shakibaeinia 2020, doi:10.1016/j.cma.2019.112700). The last terms above carry s and v along with u (ALE).
///
/// With Constants::plain_operators, B is the identity everywhere, without tensile control and ALE terms: shifting
/// with the thesis' operators.
class Corrections {
 public:
  explicit Corrections(const Constants& constants) : constants_(constants) {}

  /// Matrices, free surface and shifting velocity for the present positions; exchanges what ghosts need. Collective.
  /// `fastest`: largest speed of all water [m/s].
  void update(Particles& particles, const Neighbours& neighbours, Halo& halo, double fastest);
  /// As advance_density() and accelerate() of operators.hpp, corrected.
  void advance_density(Particles& particles, const Neighbours& neighbours) const;
  void accelerate(const Particles& particles, const Neighbours& neighbours, std::vector<Triple>& acceleration,
                  Reactions& reaction) const;

  /// Velocity of transport less that of the water, of each own water particle [m/s], as of the last update.
  [[nodiscard]] const std::vector<Triple>& shift() const { return shift_; }
  /// Of all particles, as of the last update.
  [[nodiscard]] const std::vector<Correction>& of_particles() const { return correction_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// Outward normal of a free-surface particle, zero otherwise.
  struct Surface {
    double normal[3] = {0, 0, 0};
    double is_surface = 0;
  };
  template <int D, KernelKind K>
  void measure(const Particles& particles, const Neighbours& neighbours, double fastest);
  template <int D, KernelKind K>
  void classify(const Particles& particles, const Neighbours& neighbours);
  [[nodiscard]] bool at_surface(const Particles& particles, const Neighbours& neighbours, std::size_t i,
                                const double* normal) const;

  const Constants& constants_;
  std::vector<Correction> correction_;  ///< of all particles and the sentinel
  std::vector<Surface> surface_;        ///< likewise
  std::vector<double> concentration_;   ///< SUM W / n0 of the own water
  std::vector<Triple> shift_;
};

}  // namespace embacle::mps
