#pragma once
// Holzapfel-Gasser-Ogden: a soft matrix with two families of collagen fibres.

#include <cmath>

#include "solid-server/material/exponential.hpp"
#include "solid-server/material/fibre.hpp"
#include "solid-server/material/isochoric_invariant.hpp"
#include "solid-server/material/tangent_parts.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/material/volumetric_part.hpp"

namespace couplet::solid {

/// W = mu/2 (I1bar - 3) + K/2 (J - 1)^2 + k1/(2 k2) sum_a (exp(k2 <E_a>^2) - 1),
/// E_a = kappa I1 + (1 - 3 kappa) I4_a - 1,  I1 = tr C,  I4_a = m_a.C m_a
///   [Holzapfel, Gasser, Ogden 2000, eqs. 63-65; dispersion: Gasser, Ogden, Holzapfel 2006, eqs. 3.1-3.3].
/// The families m_a lie in the plane of the tissue at plus and minus an angle from its first axis; at angle 0 they
/// coincide and both count. Two departures from the papers:
///   I1 and I4 in E_a are those of C itself, not of its isochoric part: with the isochoric part a compressible body
///   under tension grows in volume and its fibres feel no volume change [Nolan et al. 2014];
///   <E> = max(E, 0): a family pulls where its mean strain E is positive and never pushes. Without dispersion this is
///   the papers' I4 > 1; with it, the condition I4 > 1 would let the stress jump.
/// The stress is continuous where E passes 0, the tangent jumps there. A family at rest counts as pulling.
/// Defined for J > 0 only; the caller checks that.
struct HolzapfelGasserOgden {
  double mu = 0;            // shear modulus of the matrix [Pa]; c in the paper
  double bulk_modulus = 0;  // K [Pa]
  double k1 = 0;            // stiffness of a family [Pa], not negative
  double k2 = 1;            // how fast it stiffens [1], positive
  double dispersion = 0;    // kappa [1]: 0 for aligned fibres, 1/3 for fibres in all directions
  double cosine = 1;        // of the angle between the first axis and either family
  double sine = 0;

  static constexpr bool is_anisotropic = true;
  static constexpr bool needs_positive_volume = true;
  static constexpr bool has_volumetric_part = true;
  static constexpr bool may_lose_stiffness = false;

  /// The same law with its families at plus and minus `angle` [rad].
  HolzapfelGasserOgden with_fibres_at(double angle) const {
    return {mu, bulk_modulus, k1, k2, dispersion, std::cos(angle), std::sin(angle)};
  }

  /// A wave along the unit vector n feels at rest, from family a, k1 g (x) g with g = 2 (kappa n + b (n.m) m) and
  /// b = 1 - 3 kappa. Its largest eigenvalue is g.g = 4 (kappa^2 + (2 kappa + b) b (n.m)^2), and the (n.m)^2 of both
  /// families add up to 1 + |cos(2 angle)| at most: K + 4/3 mu plus this is not below rho c_p^2 in any direction [Pa].
  double pressure_wave_modulus() const {
    const double b = 1 - 3 * dispersion, cosine_of_twice = std::abs(cosine * cosine - sine * sine);
    return bulk_modulus + 4.0 / 3 * mu +
           4 * k1 * (2 * dispersion * dispersion + (2 * dispersion + b) * b * (1 + cosine_of_twice));
  }
  double shear_modulus() const { return mu; }
  double bulk_modulus_at_rest() const { return bulk_modulus; }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    const IsochoricInvariant<Real> I1(F);
    Real energy = 0.5 * mu * (I1.value - 3.0) + volumetric_part().energy(I1.J);
    for (const double sign : {1.0, -1.0}) energy += (0.5 * k1 / k2) * (Family<Real>(*this, F, axes, sign).growth - 1.0);
    return energy;
  }

  /// Of a family: k1 <E> exp(k2 <E>^2) dE/dF,  dE/dF = 2 (kappa F + (1 - 3 kappa) f (x) m).
  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    const IsochoricInvariant<Real> I1(F);
    Tensor<Real> P = I1.stress(Real{} + 0.5 * mu, volumetric_part().pressure(I1.J));
    for (const double sign : {1.0, -1.0}) {
      const Family<Real> family(*this, F, axes, sign);
      P = sum(P, scaled(2 * k1 * family.strain * family.growth, half_gradient(F, family.fibre)));
    }
    return P;
  }

  /// Of a family: k1 (1 + 2 k2 E^2) exp(k2 E^2) dE/dF (x) dE/dF where it pulls, and with the stress
  /// k1 <E> exp(k2 <E>^2) d2E/dF2,  d2E/dF_iJ dF_kL = 2 delta_ik (kappa delta_JL + (1 - 3 kappa) m_J m_L).
  template <class Real>
  [[gnu::always_inline]] inline BasicTangent<Real> tangent(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    const IsochoricInvariant<Real> I1(F);
    BasicTangent<Real> tangent =
        I1.tangent(Real{} + 0.5 * mu, volumetric_part().pressure(I1.J), volumetric_part().stiffness(I1.J));
    for (const double sign : {1.0, -1.0}) {
      const Family<Real> family(*this, F, axes, sign);
      const Tensor<Real> half = half_gradient(F, family.fibre);
      const Real stiffness = 4 * k1 * (1.0 + 2 * k2 * family.strain * family.strain) * family.growth;
      add_outer_product(scaled(family.pulls ? stiffness : Real{}, half), half, tangent);
      const Real pull = 2 * k1 * family.strain * family.growth;
      add_identity(dispersion * pull, tangent);
      add_for_equal_rows(scaled((1 - 3 * dispersion) * pull, family.fibre.m_m()), tangent);
    }
    return mirrored(tangent);
  }

  /// Fibres feel the volume too, but their energy is no function of J alone: it stays in the rest.
  VolumetricPart volumetric_part() const { return {bulk_modulus}; }
  HolzapfelGasserOgden without_volumetric_part() const { return {mu, 0, k1, k2, dispersion, cosine, sine}; }

  template <class Real>
  [[gnu::always_inline]] inline Fibre<Real> first_fibre(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    return {F, axes, cosine, sine};
  }

 private:
  /// One of the families at a point.
  template <class Real>
  struct Family {
    Fibre<Real> fibre;
    decltype(Real{} > 0.0) pulls;
    Real strain, growth;  // <E>, exp(k2 <E>^2)

    [[gnu::always_inline]] inline Family(const HolzapfelGasserOgden& law, const Tensor<Real>& F,
                                         const LocalAxes<Real>& axes, double sign)
        : fibre(F, axes, law.cosine, sign * law.sine) {
      const Real E = law.dispersion * double_contraction(F, F) + (1 - 3 * law.dispersion) * fibre.I4 - 1.0;
      // At rest E is zero to round-off, of which neither stiffness nor stable step may depend.
      pulls = E > -1e-12;
      strain = E > 0.0 ? E : Real{};
      growth = exponential(law.k2 * strain * strain);
    }
  };

  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> half_gradient(const Tensor<Real>& F, const Fibre<Real>& fibre) const {
    return sum(scaled(dispersion, F), scaled(1 - 3 * dispersion, fibre.f_m()));
  }
};

}  // namespace couplet::solid
