#pragma once
// Mooney-Rivlin with two isochoric coefficients and a bulk modulus.

#include "solid-server/material/inverse_cube_root.hpp"
#include "solid-server/material/tensor.hpp"

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

  /// K + 4/3 mu = rho c_p^2 [Pa].
  double pressure_wave_modulus() const { return bulk_modulus + 8.0 / 3 * (a10 + a01); }

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Tensor<Real>& F) const {
    const Point<Real> p(F);
    const Real change = p.J - 1.0;
    return a10 * (p.j2 * p.I1 - 3.0) + a01 * (p.j2 * p.j2 * p.I2 - 3.0) + 0.5 * bulk_modulus * change * change;
  }

  /// With dI1/dF = 2 F, dI2/dF = 2 (I1 F - F C), dJ/dF = cof F:
  /// P = alpha F - beta F C + gamma cof F,  alpha = 2 a10 J^(-2/3) + 2 a01 J^(-4/3) I1,  beta = 2 a01 J^(-4/3),
  /// gamma = K (J - 1) - (2/3 a10 J^(-2/3) I1 + 4/3 a01 J^(-4/3) I2) / J.
  template <class Real>
  [[gnu::always_inline]] inline Tensor<Real> stress(const Tensor<Real>& F) const {
    const Point<Real> p(F);
    const Real beta = (2 * a01) * (p.j2 * p.j2);
    const Real alpha = (2 * a10) * p.j2 + beta * p.I1;
    const Real gamma = bulk_modulus * (p.J - 1.0) -
                       ((2.0 / 3 * a10) * (p.j2 * p.I1) + (4.0 / 3 * a01) * (p.j2 * p.j2 * p.I2)) * p.inverse_J;
    Tensor<Real> inner;  // alpha I - beta C
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) inner.at[i][j] = i == j ? alpha - beta * p.C.at[i][j] : -beta * p.C.at[i][j];
    Tensor<Real> P = product(F, inner);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P.at[i][j] += gamma * p.cof.at[i][j];
    return P;
  }

  Tangent tangent(const Tensor<double>& F) const;

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

/// The derivative of the formula for P along each of the nine directions of F.
inline Tangent MooneyRivlin::tangent(const Tensor<double>& F) const {
  const Point<double> p(F);
  const double J = p.J, j2 = p.j2, j4 = j2 * j2;
  const double beta = 2 * a01 * j4, alpha = 2 * a10 * j2 + beta * p.I1;
  const double isochoric = 2.0 / 3 * a10 * j2 * p.I1 + 4.0 / 3 * a01 * j4 * p.I2;  // gamma = K (J - 1) - isochoric / J
  const double gamma = bulk_modulus * (J - 1) - isochoric / J;
  const Tensor<double> FC = product(F, p.C);

  Tangent tangent;
  for (int column = 0; column < 9; ++column) {
    const int k = column / 3, L = column % 3;
    const double dJ = p.cof.at[k][L], dI1 = 2 * F.at[k][L], dI2 = 2 * (p.I1 * F.at[k][L] - FC.at[k][L]);
    const double dj2 = -2.0 / 3 * j2 / J * dJ, dj4 = -4.0 / 3 * j4 / J * dJ;
    const double dbeta = 2 * a01 * dj4, dalpha = 2 * a10 * dj2 + dbeta * p.I1 + beta * dI1;
    const double disochoric = 2.0 / 3 * a10 * (dj2 * p.I1 + j2 * dI1) + 4.0 / 3 * a01 * (dj4 * p.I2 + j4 * dI2);
    const double dgamma = bulk_modulus * dJ - disochoric / J + isochoric / (J * J) * dJ;
    for (int i = 0; i < 3; ++i)
      for (int M = 0; M < 3; ++M) {
        const double dF = i == k && M == L ? 1 : 0;
        // d(F C) = dF C + F dF^T F + F F^T dF with dF = e_k (x) E_L.
        double dFC = i == k ? p.C.at[L][M] : 0;
        dFC += F.at[i][L] * F.at[k][M];
        if (M == L)
          for (int N = 0; N < 3; ++N) dFC += F.at[i][N] * F.at[k][N];
        // d cof_iM = eps_ikm eps_MLN F_mN.
        double dcof = 0;
        if (i != k && M != L) {
          const double sign = ((k - i + 3) % 3 == 1 ? 1 : -1) * ((L - M + 3) % 3 == 1 ? 1 : -1);
          dcof = sign * F.at[3 - i - k][3 - M - L];
        }
        tangent(3 * i + M, column) = dalpha * F.at[i][M] + alpha * dF - dbeta * FC.at[i][M] - beta * dFC +
                                     dgamma * p.cof.at[i][M] + gamma * dcof;
      }
  }
  return tangent;
}

}  // namespace couplet::solid
