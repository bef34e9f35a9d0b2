#pragma once
// Neo-Hooke with a bulk modulus.

#include "solid-server/material/isochoric_invariant.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/material/volumetric_part.hpp"

namespace couplet::solid {

/// W = mu/2 (I1bar - 3) + K/2 (J - 1)^2,  I1bar = J^(-2/3) tr(F^T F)   [Holzapfel 2000, 6.5].
/// Defined for J > 0 only; the caller checks that.
struct NeoHookean {
  double mu = 0;            // initial shear modulus [Pa]
  double bulk_modulus = 0;  // K [Pa]

  static constexpr bool is_anisotropic = false;
  static constexpr bool needs_positive_volume = true;
  static constexpr bool has_volumetric_part = true;
  static constexpr bool may_lose_stiffness = false;

  /// mu = E / (2 (1 + nu)),  K = E / (3 (1 - 2 nu)).
  static NeoHookean from_young(double young_modulus, double poisson_ratio) {
    return {young_modulus / (2 * (1 + poisson_ratio)), young_modulus / (3 * (1 - 2 * poisson_ratio))};
  }

  /// K + 4/3 mu = rho c_p^2 [Pa].
  double pressure_wave_modulus() const { return bulk_modulus + 4.0 / 3 * mu; }
  double shear_modulus() const { return mu; }
  double bulk_modulus_at_rest() const { return bulk_modulus; }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F) const {
    const IsochoricInvariant<Real> I1(F);
    return 0.5 * mu * (I1.value - 3.0) + volumetric_part().energy(I1.J);
  }

  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F) const {
    const IsochoricInvariant<Real> I1(F);
    return I1.stress(Real{} + 0.5 * mu, volumetric_part().pressure(I1.J));
  }

  template <class Real>
  [[gnu::always_inline]] inline BasicTangent<Real> tangent(const Tensor<Real>& F) const {
    const IsochoricInvariant<Real> I1(F);
    return mirrored(I1.tangent(Real{} + 0.5 * mu, volumetric_part().pressure(I1.J), volumetric_part().stiffness(I1.J)));
  }

  VolumetricPart volumetric_part() const { return {bulk_modulus}; }
  NeoHookean without_volumetric_part() const { return {mu, 0}; }
};

}  // namespace couplet::solid
