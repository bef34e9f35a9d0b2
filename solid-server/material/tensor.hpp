#pragma once
// Tensors at one point, of one number each or of a pack of eight (pack.hpp): the same formulas serve both.

#include <Eigen/Core>

namespace couplet::solid {

template <class Real>
struct Tensor {
  Real at[3][3];
};

/// Axes of the tissue at rest, as unit vectors: at[0] along the fibres, at[1] across them in the plane of the tissue.
template <class Real>
struct LocalAxes {
  Real at[2][3];
};

/// d2W/dF2 = dP/dF [Pa], index 3 i + J in both directions; symmetric.
template <class Real>
struct BasicTangent {
  Real at[9][9];
};

/// A^T A, the right Cauchy-Green tensor of a deformation gradient.
template <class Real>
[[gnu::always_inline]] inline Tensor<Real> transpose_product(const Tensor<Real>& a) {
  Tensor<Real> c;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      c.at[i][j] = a.at[0][i] * a.at[0][j] + a.at[1][i] * a.at[1][j] + a.at[2][i] * a.at[2][j];
      c.at[j][i] = c.at[i][j];
    }
  return c;
}

template <class Real>
[[gnu::always_inline]] inline Tensor<Real> product(const Tensor<Real>& a, const Tensor<Real>& b) {
  Tensor<Real> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c.at[i][j] = a.at[i][0] * b.at[0][j] + a.at[i][1] * b.at[1][j] + a.at[i][2] * b.at[2][j];
  return c;
}

/// A B^T.
template <class Real>
[[gnu::always_inline]] inline Tensor<Real> product_transpose(const Tensor<Real>& a, const Tensor<Real>& b) {
  Tensor<Real> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c.at[i][j] = a.at[i][0] * b.at[j][0] + a.at[i][1] * b.at[j][1] + a.at[i][2] * b.at[j][2];
  return c;
}

/// A factor of one number for all points, or of one for each.
template <class Factor, class Real>
[[gnu::always_inline]] inline Tensor<Real> scaled(const Factor& factor, const Tensor<Real>& a) {
  Tensor<Real> c;
  for (int n = 0; n < 9; ++n) c.at[n / 3][n % 3] = factor * a.at[n / 3][n % 3];
  return c;
}

template <class Real>
[[gnu::always_inline]] inline Tensor<Real> sum(const Tensor<Real>& a, const Tensor<Real>& b) {
  Tensor<Real> c;
  for (int n = 0; n < 9; ++n) c.at[n / 3][n % 3] = a.at[n / 3][n % 3] + b.at[n / 3][n % 3];
  return c;
}

/// Cofactor: det(A) A^-T = d det(A) / dA.
template <class Real>
[[gnu::always_inline]] inline Tensor<Real> cofactor(const Tensor<Real>& a) {
  Tensor<Real> c;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c.at[i][j] = a.at[i1][j1] * a.at[i2][j2] - a.at[i1][j2] * a.at[i2][j1];
    }
  }
  return c;
}

/// det(A) from A and its cofactor.
template <class Real>
[[gnu::always_inline]] inline Real determinant(const Tensor<Real>& a, const Tensor<Real>& cof) {
  return a.at[0][0] * cof.at[0][0] + a.at[0][1] * cof.at[0][1] + a.at[0][2] * cof.at[0][2];
}

template <class Real>
[[gnu::always_inline]] inline Tensor<Real> inverse(const Tensor<Real>& a) {
  const Tensor<Real> cof = cofactor(a);
  const Real factor = 1.0 / determinant(a, cof);
  Tensor<Real> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c.at[i][j] = factor * cof.at[j][i];
  return c;
}

template <class Real>
[[gnu::always_inline]] inline Real double_contraction(const Tensor<Real>& a, const Tensor<Real>& b) {
  Real sum = a.at[0][0] * b.at[0][0];
  for (int n = 1; n < 9; ++n) sum += a.at[n / 3][n % 3] * b.at[n / 3][n % 3];
  return sum;
}

/// The same for algebra in plain code.
using Tangent = Eigen::Matrix<double, 9, 9>;

inline Tangent as_matrix(const BasicTangent<double>& tangent) {
  return Eigen::Map<const Eigen::Matrix<double, 9, 9, Eigen::RowMajor>>(&tangent.at[0][0]);
}

}  // namespace couplet::solid
