#pragma once
// May-Newman: the tissue of mitral valve leaflets, with one family of fibres.

#include "solid-server/material/exponential.hpp"
#include "solid-server/material/fibre.hpp"
#include "solid-server/material/inverse_square_root.hpp"
#include "solid-server/material/isochoric_invariant.hpp"
#include "solid-server/material/tangent_parts.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/material/volumetric_part.hpp"

namespace couplet::solid {

/// W = c0 (exp(Q) - 1) + c_nh/2 (I1bar - 3) + K/2 (J - 1)^2,  Q = c1 (I1bar - 3)^2 + c2 (alpha - 1)^4
///   [May-Newman, Yin 1998], alpha = |F m| the stretch along the first axis of the tissue, in tension and compression.
/// Q is of fourth order in the strain: c0 alone has no shear stiffness at rest, so a body of it is a mechanism there:
/// its static problem is singular and its shear waves stand still. The matrix term c_nh, not in the paper, gives it
/// one. The paper's tissue is incompressible; K and I1bar instead of I1 make it nearly so. alpha is that of F itself,
/// not of its isochoric part, for the reason in HolzapfelGasserOgden. Defined for J > 0 only; the caller checks that.
struct MayNewman {
  double c0 = 0;                    // [Pa]
  double c1 = 0;                    // [1]
  double c2 = 0;                    // [1]
  double matrix_shear_modulus = 0;  // c_nh [Pa]
  double bulk_modulus = 0;          // K [Pa]

  static constexpr bool is_anisotropic = true;
  static constexpr bool needs_positive_volume = true;
  static constexpr bool has_volumetric_part = true;
  static constexpr bool may_lose_stiffness = false;

  /// K + 4/3 c_nh = rho c_p^2 at rest, in every direction [Pa]; the fibres have no stiffness there.
  double pressure_wave_modulus() const { return bulk_modulus + 4.0 / 3 * matrix_shear_modulus; }
  double shear_modulus() const { return matrix_shear_modulus; }
  double bulk_modulus_at_rest() const { return bulk_modulus; }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    const Point<Real> p(*this, F, axes);
    return p.grown - c0 + 0.5 * matrix_shear_modulus * p.x + volumetric_part().energy(p.I1.J);
  }

  /// dW/dI1bar dI1bar/dF + dW/dalpha f (x) m / alpha + U' cof F.
  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    const Point<Real> p(*this, F, axes);
    return sum(p.I1.stress(p.w_1, volumetric_part().pressure(p.I1.J)),
               scaled(p.w_alpha * p.inverse_alpha, p.fibre.f_m()));
  }

  /// With a = dalpha/dF = f (x) m / alpha, b = dI1bar/dF, d2alpha/dF_iJ dF_kL = (delta_ik m_J m_L - a_iJ a_kL)/alpha
  /// and Q_1 = 2 c1 (I1bar - 3), Q_a = 4 c2 (alpha - 1)^3: the fibres and their tie to the matrix add
  /// b (x) (W_11 b + W_1a a) + a (x) (W_1a b + (W_aa - W_a/alpha) a) + W_a/alpha delta_ik m_J m_L,
  /// W_11 = c0 exp(Q) (2 c1 + Q_1^2),  W_1a = c0 exp(Q) Q_1 Q_a,  W_aa = c0 exp(Q) (12 c2 (alpha - 1)^2 + Q_a^2).
  template <class Real>
  [[gnu::always_inline]] inline BasicTangent<Real> tangent(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    const Point<Real> p(*this, F, axes);
    const Real w_11 = p.grown * (2 * c1 + p.q_1 * p.q_1), w_1a = p.grown * p.q_1 * p.q_alpha,
               w_aa = p.grown * (12 * c2 * p.y * p.y + p.q_alpha * p.q_alpha), along = p.w_alpha * p.inverse_alpha;
    const Tensor<Real> a = scaled(p.inverse_alpha, p.fibre.f_m()), b = p.I1.gradient();
    BasicTangent<Real> tangent =
        p.I1.tangent(p.w_1, volumetric_part().pressure(p.I1.J), volumetric_part().stiffness(p.I1.J));
    add_outer_product(b, sum(scaled(w_11, b), scaled(w_1a, a)), tangent);
    add_outer_product(a, sum(scaled(w_1a, b), scaled(w_aa - along, a)), tangent);
    add_for_equal_rows(scaled(along, p.fibre.m_m()), tangent);
    return mirrored(tangent);
  }

  VolumetricPart volumetric_part() const { return {bulk_modulus}; }
  MayNewman without_volumetric_part() const { return {c0, c1, c2, matrix_shear_modulus, 0}; }

  template <class Real>
  [[gnu::always_inline]] inline Fibre<Real> first_fibre(const Tensor<Real>& F, const LocalAxes<Real>& axes) const {
    return {F, axes, 1, 0};
  }

 private:
  /// What every formula above needs at a point.
  template <class Real>
  struct Point {
    IsochoricInvariant<Real> I1;
    Fibre<Real> fibre;
    Real inverse_alpha, x, y;  // x = I1bar - 3, y = alpha - 1
    Real q_1, q_alpha, grown;  // derivatives of Q; c0 exp(Q)
    Real w_1, w_alpha;         // derivatives of W

    [[gnu::always_inline]] inline Point(const MayNewman& law, const Tensor<Real>& F, const LocalAxes<Real>& axes)
        : I1(F), fibre(law.first_fibre(F, axes)) {
      inverse_alpha = inverse_square_root(fibre.I4);
      x = I1.value - 3.0;
      y = fibre.I4 * inverse_alpha - 1.0;
      q_1 = 2 * law.c1 * x;
      q_alpha = 4 * law.c2 * y * y * y;
      grown = law.c0 * exponential(law.c1 * x * x + law.c2 * (y * y) * (y * y));
      w_1 = grown * q_1 + 0.5 * law.matrix_shear_modulus;
      w_alpha = grown * q_alpha;
    }
  };
};

}  // namespace couplet::solid
