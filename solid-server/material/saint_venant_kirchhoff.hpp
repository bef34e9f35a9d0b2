#pragma once
// Saint Venant-Kirchhoff: a linear law between Green strain and second Piola-Kirchhoff stress.

#include "solid-server/material/tangent_parts.hpp"
#include "solid-server/material/tensor.hpp"

namespace couplet::solid {

/// E = (F^T F - I)/2,  W = lambda/2 (tr E)^2 + mu E:E,  S = lambda tr(E) I + 2 mu E,  P = F S   [Holzapfel 2000, 6.5].
struct SaintVenantKirchhoff {
  double lame_lambda = 0;  // lambda [Pa]
  double lame_mu = 0;      // mu, the shear modulus [Pa]

  static constexpr bool is_anisotropic = false;
  static constexpr bool needs_positive_volume = false;
  static constexpr bool has_volumetric_part = false;
  static constexpr bool may_lose_stiffness = true;

  /// lambda = E nu / ((1 + nu)(1 - 2 nu)),  mu = E / (2 (1 + nu)).
  static SaintVenantKirchhoff from_young(double young_modulus, double poisson_ratio) {
    const double E = young_modulus, nu = poisson_ratio;
    return {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))};
  }

  /// lambda + 2 mu = rho c_p^2 [Pa].
  double pressure_wave_modulus() const { return lame_lambda + 2 * lame_mu; }
  double shear_modulus() const { return lame_mu; }
  double bulk_modulus_at_rest() const { return lame_lambda + 2.0 / 3 * lame_mu; }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F) const {
    const Tensor<Real> E = green_strain(F);
    const Real trace = E.at[0][0] + E.at[1][1] + E.at[2][2];
    return 0.5 * lame_lambda * trace * trace + lame_mu * double_contraction(E, E);
  }

  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F) const {
    return product(F, second_piola(green_strain(F)));
  }

  /// dP = dF S + F (lambda tr(dE) I + 2 mu dE),  dE = sym(F^T dF):
  /// dP_iJ/dF_kL = delta_ik S_JL + lambda F_iJ F_kL + mu (F_iL F_kJ + delta_JL B_ik),  B = F F^T.
  template <class Real>
  [[gnu::always_inline]] inline BasicTangent<Real> tangent(const Tensor<Real>& F) const {
    const Tensor<Real> mu_F = scaled(lame_mu, F);
    BasicTangent<Real> tangent = outer_product(scaled(lame_lambda, F), F);
    add_exchanged_product(mu_F, F, tangent);
    add_for_equal_columns(product_transpose(mu_F, F), tangent);
    add_for_equal_rows(second_piola(green_strain(F)), tangent);
    return mirrored(tangent);
  }

  /// Under uniaxial load P = E/2 (l^3 - l), and with the sides held fixed P = (lambda + 2 mu)/2 (l^3 - l): both have
  /// dP/dl = 0 at the stretch l = 1/sqrt(3), below which the law yields to further compression. True where the
  /// smallest principal stretch is below it: where C - I/3 is not positive definite, by its leading minors.
  /// A bool, or for a pack a mask.
  template <class Real>
  [[gnu::always_inline]] inline auto loses_stiffness(const Tensor<Real>& F) const {
    Tensor<Real> A = transpose_product(F);
    for (int i = 0; i < 3; ++i) A.at[i][i] -= 1.0 / 3;
    const Real minor = A.at[0][0] * A.at[1][1] - A.at[0][1] * A.at[1][0];
    return !((A.at[0][0] > 0.0) & (minor > 0.0) & (determinant(A, cofactor(A)) > 0.0));
  }

 private:
  template <class Real>
  [[gnu::always_inline]] static inline Tensor<Real> green_strain(const Tensor<Real>& F) {
    Tensor<Real> E = transpose_product(F);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) E.at[i][j] = 0.5 * (i == j ? E.at[i][j] - 1.0 : E.at[i][j]);
    return E;
  }

  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> second_piola(const Tensor<Real>& E) const {
    const Real volumetric = lame_lambda * (E.at[0][0] + E.at[1][1] + E.at[2][2]);
    Tensor<Real> S;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        S.at[i][j] = (2 * lame_mu) * E.at[i][j];
        if (i == j) S.at[i][j] += volumetric;
      }
    return S;
  }
};

}  // namespace couplet::solid
