#pragma once
// The terms that tangents are sums of. Each writes the upper half only, columns not before the row; what a law adds up
// is symmetric, and mirrored() copies the upper half to the lower at the end.
//
// Loops run over all nine columns and skip: with constant bounds the compiler unrolls them and drops the skipped part.

#include "solid-server/material/tensor.hpp"

namespace couplet::solid {

/// a_iJ b_kL.
template <class Real>
[[gnu::always_inline]] inline BasicTangent<Real> outer_product(const Tensor<Real>& a, const Tensor<Real>& b) {
  BasicTangent<Real> tangent;
#pragma GCC unroll 9
  for (int row = 0; row < 9; ++row)
#pragma GCC unroll 9
    for (int column = 0; column < 9; ++column)
      if (column >= row) tangent.at[row][column] = a.at[row / 3][row % 3] * b.at[column / 3][column % 3];
  return tangent;
}

template <class Real>
[[gnu::always_inline]] inline void add_outer_product(const Tensor<Real>& a, const Tensor<Real>& b,
                                                     BasicTangent<Real>& tangent) {
#pragma GCC unroll 9
  for (int row = 0; row < 9; ++row)
#pragma GCC unroll 9
    for (int column = 0; column < 9; ++column)
      if (column >= row) tangent.at[row][column] += a.at[row / 3][row % 3] * b.at[column / 3][column % 3];
}

/// a_iL b_kJ: the outer product with its second indices exchanged. Symmetric for a = b.
template <class Real>
[[gnu::always_inline]] inline void add_exchanged_product(const Tensor<Real>& a, const Tensor<Real>& b,
                                                         BasicTangent<Real>& tangent) {
#pragma GCC unroll 9
  for (int row = 0; row < 9; ++row)
#pragma GCC unroll 9
    for (int column = 0; column < 9; ++column)
      if (column >= row) tangent.at[row][column] += a.at[row / 3][column % 3] * b.at[column / 3][row % 3];
}

/// delta_ik S_JL for a symmetric S: what a second Piola-Kirchhoff stress adds.
template <class Real>
[[gnu::always_inline]] inline void add_for_equal_rows(const Tensor<Real>& S, BasicTangent<Real>& tangent) {
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int J = 0; J < 3; ++J)
#pragma GCC unroll 3
      for (int L = 0; L < 3; ++L)
        if (L >= J) tangent.at[3 * i + J][3 * i + L] += S.at[J][L];
}

/// delta_JL B_ik for a symmetric B.
template <class Real>
[[gnu::always_inline]] inline void add_for_equal_columns(const Tensor<Real>& B, BasicTangent<Real>& tangent) {
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k)
#pragma GCC unroll 3
      for (int J = 0; J < 3; ++J)
        if (k >= i) tangent.at[3 * i + J][3 * k + J] += B.at[i][k];
}

/// factor delta_ik delta_JL.
template <class Real>
[[gnu::always_inline]] inline void add_identity(const Real& factor, BasicTangent<Real>& tangent) {
#pragma GCC unroll 9
  for (int row = 0; row < 9; ++row) tangent.at[row][row] += factor;
}

/// factor d2J/dF2 = factor eps_ikm eps_JLN F_mN: nothing for i = k or J = L, else plus or minus the one entry of F that
/// lies in neither row nor column.
template <class Real>
[[gnu::always_inline]] inline void add_second_derivative_of_volume(const Real& factor, const Tensor<Real>& F,
                                                                   BasicTangent<Real>& tangent) {
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i)
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k)
#pragma GCC unroll 3
      for (int J = 0; J < 3; ++J)
#pragma GCC unroll 3
        for (int L = 0; L < 3; ++L)
          if (k > i && J != L) {
            const bool same_turn = (k - i == 1) == ((L - J + 3) % 3 == 1);
            const Real part = factor * F.at[3 - i - k][3 - J - L];
            if (same_turn)
              tangent.at[3 * i + J][3 * k + L] += part;
            else
              tangent.at[3 * i + J][3 * k + L] -= part;
          }
}

template <class Real>
[[gnu::always_inline]] inline BasicTangent<Real> mirrored(const BasicTangent<Real>& upper) {
  BasicTangent<Real> tangent = upper;
#pragma GCC unroll 9
  for (int row = 0; row < 9; ++row)
#pragma GCC unroll 9
    for (int column = 0; column < 9; ++column)
      if (column < row) tangent.at[row][column] = upper.at[column][row];
  return tangent;
}

}  // namespace couplet::solid
