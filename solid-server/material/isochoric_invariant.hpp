#pragma once
// The part of a law that feels I1bar and J, with its derivatives: the matrix of every tissue here.

#include "solid-server/material/inverse_cube_root.hpp"
#include "solid-server/material/tangent_parts.hpp"
#include "solid-server/material/tensor.hpp"

namespace couplet::solid {

/// I1bar = J^(-2/3) tr(F^T F) [1] at a point with J > 0, and what the derivatives of W(I1bar, J) by F are made of:
///   dJ/dF = cof F,  dI1bar/dF = 2 J^(-2/3) F - 2/3 I1bar/J cof F   [Holzapfel 2000, 6.4].
/// w_ is a derivative of W by I1bar, u_ one by J.
template <class Real>
struct IsochoricInvariant {
  Tensor<Real> F, cof;
  Real J, inverse_J, j2, value;  // j2 = J^(-2/3), value = I1bar

  [[gnu::always_inline]] inline explicit IsochoricInvariant(const Tensor<Real>& at) : F(at), cof(cofactor(at)) {
    J = determinant(F, cof);
    const Real j1 = inverse_cube_root(J);
    j2 = j1 * j1;
    inverse_J = j2 * j1;
    value = j2 * double_contraction(F, F);
  }

  [[gnu::always_inline]] inline Tensor<Real> gradient() const {
    return sum(scaled(2.0 * j2, F), scaled((-2.0 / 3) * value * inverse_J, cof));
  }

  /// w_1 dI1bar/dF + u_1 dJ/dF.
  [[gnu::always_inline]] inline Tensor<Real> stress(const Real& w_1, const Real& u_1) const {
    return sum(scaled(2.0 * w_1 * j2, F), scaled(u_1 - (2.0 / 3) * w_1 * value * inverse_J, cof));
  }

  /// w_1 d2I1bar/dF2 + u_1 d2J/dF2 + u_2 dJ/dF (x) dJ/dF, the upper half:
  /// d2I1bar/dF2 = 2 J^(-2/3) I - 4/3 J^(-5/3) (F (x) cof F + cof F (x) F) + 10/9 I1bar/J^2 cof F (x) cof F
  ///               - 2/3 I1bar/J d2J/dF2.
  [[gnu::always_inline]] inline BasicTangent<Real> tangent(const Real& w_1, const Real& u_1, const Real& u_2) const {
    const Real w_1_over_J = w_1 * inverse_J;
    const Tensor<Real> mixed = scaled((-4.0 / 3) * w_1_over_J * j2, F);
    BasicTangent<Real> tangent = outer_product(mixed, cof);
    add_outer_product(cof, sum(mixed, scaled(u_2 + (10.0 / 9) * w_1_over_J * inverse_J * value, cof)), tangent);
    add_second_derivative_of_volume(u_1 - (2.0 / 3) * w_1_over_J * value, F, tangent);
    add_identity(2.0 * w_1 * j2, tangent);
    return tangent;
  }
};

}  // namespace couplet::solid
