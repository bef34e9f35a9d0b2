#pragma once
// Mooney-Rivlin with two isochoric coefficients and a bulk modulus.

#include "solid-server/material/inverse_cube_root.hpp"
#include "solid-server/material/tangent_parts.hpp"
#include "solid-server/material/tensor.hpp"
#include "solid-server/material/volumetric_part.hpp"

namespace couplet::solid {

/// W = a10 (I1bar - 3) + a01 (I2bar - 3) + K/2 (J - 1)^2,  I1bar = J^(-2/3) I1,  I2bar = J^(-4/3) I2,
/// I1 = tr C,  I2 = (I1^2 - C:C)/2,  C = F^T F   [Holzapfel 2000, 6.4-6.5]. Initial shear modulus 2 (a10 + a01).
/// Defined for J > 0 only; the caller checks that.
struct MooneyRivlin {
  double a10 = 0;           // [Pa]
  double a01 = 0;           // [Pa]
  double bulk_modulus = 0;  // K [Pa]

  static constexpr bool is_anisotropic = false;
  static constexpr bool needs_positive_volume = true;
  static constexpr bool has_volumetric_part = true;
  static constexpr bool may_lose_stiffness = false;

  /// K + 4/3 mu = rho c_p^2 [Pa].
  double pressure_wave_modulus() const { return bulk_modulus + 8.0 / 3 * (a10 + a01); }
  double shear_modulus() const { return 2 * (a10 + a01); }
  double bulk_modulus_at_rest() const { return bulk_modulus; }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F) const {
    const Point<Real> p(F);
    return a10 * (p.j2 * p.I1 - 3.0) + a01 * (p.j2 * p.j2 * p.I2 - 3.0) + volumetric_part().energy(p.J);
  }

  /// With dI1/dF = 2 F, dI2/dF = 2 (I1 F - F C), dJ/dF = cof F:
  /// P = alpha F - beta F C + gamma cof F,  alpha = 2 a10 J^(-2/3) + 2 a01 J^(-4/3) I1,  beta = 2 a01 J^(-4/3),
  /// gamma = K (J - 1) - (2/3 a10 J^(-2/3) I1 + 4/3 a01 J^(-4/3) I2) / J.
  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F) const {
    const Point<Real> p(F);
    const Real beta = (2 * a01) * (p.j2 * p.j2);
    const Real alpha = (2 * a10) * p.j2 + beta * p.I1;
    const Real gamma = volumetric_part().pressure(p.J) -
                       ((2.0 / 3 * a10) * (p.j2 * p.I1) + (4.0 / 3 * a01) * (p.j2 * p.j2 * p.I2)) * p.inverse_J;
    Tensor<Real> inner;  // alpha I - beta C
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) inner.at[i][j] = i == j ? alpha - beta * p.C.at[i][j] : -beta * p.C.at[i][j];
    Tensor<Real> P = product(F, inner);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P.at[i][j] += gamma * p.cof.at[i][j];
    return P;
  }

  /// The derivative of the formula above. With H = F^-T = cof F / J, B = F F^T, q = 4/3 (a10 J^(-2/3) + beta I1):
  /// dP_iJ/dF_kL = alpha delta_ik delta_JL - beta (delta_ik C_JL + delta_JL B_ik + F_iL F_kJ) + gamma d2J/dF2
  ///   + 2 beta F_iJ F_kL + v_iJ H_kL + H_iJ v_kL + h H_iJ H_kL,  v = 4/3 beta F C - q F,
  /// h = K J^2 + 10/9 a10 J^(-2/3) I1 + 28/9 a01 J^(-4/3) I2.
  template <class Real>
  [[gnu::always_inline]] inline BasicTangent<Real> tangent(const Tensor<Real>& F) const {
    const Point<Real> p(F);
    const Real beta = (2 * a01) * (p.j2 * p.j2), a10_part = a10 * p.j2, I1_part = a10_part * p.I1,
               I2_part = 0.5 * beta * p.I2;
    const Real gamma = volumetric_part().pressure(p.J) - ((2.0 / 3) * I1_part + (4.0 / 3) * I2_part) * p.inverse_J;
    const Real h = bulk_modulus * p.J * p.J + (10.0 / 9) * I1_part + (28.0 / 9) * I2_part;
    const Tensor<Real> H = scaled(p.inverse_J, p.cof);
    const Tensor<Real> beta_F = scaled(beta, F), minus_beta_F = scaled(-beta, F);
    const Tensor<Real> v =
        sum(scaled((4.0 / 3), product(beta_F, p.C)), scaled((-4.0 / 3) * (a10_part + beta * p.I1), F));

    BasicTangent<Real> tangent = outer_product(v, H);
    add_outer_product(H, sum(v, scaled(h, H)), tangent);
    add_outer_product(scaled(2.0, beta_F), F, tangent);
    add_exchanged_product(minus_beta_F, F, tangent);
    add_for_equal_columns(product_transpose(minus_beta_F, F), tangent);
    add_for_equal_rows(scaled(-beta, p.C), tangent);
    add_identity(2.0 * a10_part + beta * p.I1, tangent);
    add_second_derivative_of_volume(gamma, F, tangent);
    return mirrored(tangent);
  }

  VolumetricPart volumetric_part() const { return {bulk_modulus}; }
  MooneyRivlin without_volumetric_part() const { return {a10, a01, 0}; }

 private:
  /// What every formula above needs at a point.
  template <class Real>
  struct Point {
    Tensor<Real> C, cof;
    Real J, I1, I2, j2, inverse_J;  // j2 = J^(-2/3)

    [[gnu::always_inline]] inline explicit Point(const Tensor<Real>& F) : C(transpose_product(F)), cof(cofactor(F)) {
      J = determinant(F, cof);
      I1 = C.at[0][0] + C.at[1][1] + C.at[2][2];
      I2 = 0.5 * (I1 * I1 - double_contraction(C, C));
      const Real j1 = inverse_cube_root(J);
      j2 = j1 * j1;
      inverse_J = j2 * j1;
    }
  };
};

}  // namespace couplet::solid
