#pragma once
// Saint Venant-Kirchhoff: a linear law between Green strain and second Piola-Kirchhoff stress.

#include "solid-server/material/tensor.hpp"

namespace couplet::solid {

/// E = (F^T F - I)/2,  W = lambda/2 (tr E)^2 + mu E:E,  S = lambda tr(E) I + 2 mu E,  P = F S   [Holzapfel 2000, 6.5].
struct SaintVenantKirchhoff {
  double lame_lambda = 0;    // lambda [Pa]
  double shear_modulus = 0;  // mu [Pa]

  static constexpr bool is_anisotropic = false;
  static constexpr bool needs_positive_volume = false;

  /// lambda = E nu / ((1 + nu)(1 - 2 nu)),  mu = E / (2 (1 + nu)).
  static SaintVenantKirchhoff from_young(double young_modulus, double poisson_ratio) {
    const double E = young_modulus, nu = poisson_ratio;
    return {E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))};
  }

  /// lambda + 2 mu = rho c_p^2 [Pa].
  double pressure_wave_modulus() const { return lame_lambda + 2 * shear_modulus; }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F) const {
    const Tensor<Real> E = green_strain(F);
    const Real trace = E.at[0][0] + E.at[1][1] + E.at[2][2];
    return 0.5 * lame_lambda * trace * trace + shear_modulus * double_contraction(E, E);
  }

  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F) const {
    return product(F, second_piola(green_strain(F)));
  }

  /// dP = dF S + F (lambda tr(dE) I + 2 mu dE),  dE = sym(F^T dF).
  Tangent tangent(const Tensor<double>& F) const {
    const Tensor<double> S = second_piola(green_strain(F));
    Tangent tangent;
    for (int column = 0; column < 9; ++column) {
      Tensor<double> dF{}, dE;
      dF.at[column / 3][column % 3] = 1;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          dE.at[i][j] = 0;
          for (int k = 0; k < 3; ++k) dE.at[i][j] += 0.5 * (F.at[k][i] * dF.at[k][j] + dF.at[k][i] * F.at[k][j]);
        }
      const Tensor<double> first = product(dF, S), second = product(F, second_piola(dE));
      for (int row = 0; row < 9; ++row) tangent(row, column) = first.at[row / 3][row % 3] + second.at[row / 3][row % 3];
    }
    return tangent;
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
        S.at[i][j] = (2 * shear_modulus) * E.at[i][j];
        if (i == j) S.at[i][j] += volumetric;
      }
    return S;
  }
};

}  // namespace couplet::solid
