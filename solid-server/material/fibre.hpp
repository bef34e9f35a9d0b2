#pragma once
// What a fibre through a point feels.

#include "solid-server/material/tensor.hpp"

namespace couplet::solid {

/// A fibre of unit direction m at rest, along f = F m now: I4 = f.f is the square of its stretch
/// [Holzapfel, Gasser, Ogden 2000, eq. 58].
template <class Real>
struct Fibre {
  Real m[3], f[3];
  Real I4;

  /// A fibre in the plane of the tissue, turned by an angle from the first axis to the second.
  [[gnu::always_inline]] inline Fibre(const Tensor<Real>& F, const LocalAxes<Real>& axes, double cosine, double sine) {
    for (int J = 0; J < 3; ++J) m[J] = cosine * axes.at[0][J] + sine * axes.at[1][J];
    for (int i = 0; i < 3; ++i) f[i] = F.at[i][0] * m[0] + F.at[i][1] * m[1] + F.at[i][2] * m[2];
    I4 = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
  }

  /// f (x) m = half of dI4/dF.
  [[gnu::always_inline]] inline Tensor<Real> f_m() const { return dyad(f, m); }
  /// m (x) m: half of d2I4/dF_iJ dF_kL is delta_ik m_J m_L.
  [[gnu::always_inline]] inline Tensor<Real> m_m() const { return dyad(m, m); }

 private:
  [[gnu::always_inline]] static inline Tensor<Real> dyad(const Real (&a)[3], const Real (&b)[3]) {
    Tensor<Real> product;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) product.at[i][j] = a[i] * b[j];
    return product;
  }
};

}  // namespace couplet::solid
