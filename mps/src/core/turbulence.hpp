// Turbulence below the size of the particles: the Smagorinsky model.
#pragma once

#include <vector>

#include "core/constants.hpp"
#include "core/halo.hpp"
#include "core/neighbours.hpp"
#include "core/operators.hpp"
#include "core/particles.hpp"

namespace embacle::mps {

/// Sub-particle-scale model (Smagorinsky 1963, doi:10.1175/1520-0493(1963)091<0099:GCEWTP>2.3.CO;2; in MPS: Gotoh,
/// Shibahara & Sakai 2001, Comput. Fluid Dyn. J. 9, 339). Each water particle has the eddy viscosity
///   nu_t = (Cs l0)^2 |S|,  |S|^2 = 2 S:S,  S = (grad v + grad v^T)/2,
///   grad v = SUM (v_j - v_i) r F [SUM F r r]^-1 over water neighbours: exact for linear fields on any arrangement;
/// where these are too few, (d/n0) SUM (v_j - v_i) r F. A pair of water particles contributes
///   (nu_t,i + nu_t,j)/2 (2d/(lambda n0)) (v_j - v_i) F r^2,
/// which is antisymmetric. Walls and bodies feel no eddy viscosity, and the isotropic part of the stress is left to the
/// pressure. No limit of the time step is needed: nu_t dt/l0^2 is about Cs^2 times the Courant number of the flow.
class Turbulence {
 public:
  explicit Turbulence(const Constants& constants) : constants_(constants) {}

  /// Adds to the acceleration [m/s^2] of the own water. Exchanges the ghosts' eddy viscosity. Collective.
  void apply(const Particles& particles, const Neighbours& neighbours, Halo& halo, std::vector<Triple>& acceleration);

  /// Eddy viscosity [m^2/s] of all particles as of the last application; zero for solids.
  [[nodiscard]] const std::vector<double>& viscosity() const { return viscosity_; }
  [[nodiscard]] std::size_t bytes() const { return viscosity_.capacity() * sizeof(double); }

 private:
  template <int D, KernelKind K>
  void measure(const Particles& particles, const Neighbours& neighbours);
  template <int D, KernelKind K>
  void add(const Particles& particles, const Neighbours& neighbours, std::vector<Triple>& acceleration) const;

  const Constants& constants_;
  std::vector<double> viscosity_;
};

}  // namespace embacle::mps
