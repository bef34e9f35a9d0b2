#pragma once
// Laws to test with, and tensors to and from matrices.

#include <Eigen/Core>

#include "solid-server/material/material.hpp"

namespace couplet::solid {

using Matrix = Eigen::Matrix3d;

inline Tensor<double> tensor(const Matrix& m) {
  Tensor<double> t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t.at[i][j] = m(i, j);
  return t;
}

inline Matrix matrix(const Tensor<double>& t) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&t.at[0][0]);
}

/// The first two columns of a rotation.
inline LocalAxes<double> axes_of(const Matrix& rotation) {
  LocalAxes<double> axes;
  for (int n = 0; n < 2; ++n)
    for (int i = 0; i < 3; ++i) axes.at[n][i] = rotation(i, n);
  return axes;
}

template <class M>
M example();
template <>
inline SaintVenantKirchhoff example() {
  return SaintVenantKirchhoff::from_young(15e3, 0.475);
}
template <>
inline NeoHookean example() {
  return {5080, 100e3};
}
template <>
inline MooneyRivlin example() {
  return {2290, 250, 100e3};
}
template <>
inline HolzapfelGasserOgden example() {
  return HolzapfelGasserOgden{3000, 100e3, 2363, 0.84, 0.1}.with_fibres_at(0.5);
}
template <>
inline MayNewman example() {
  return {399, 4.325, 20, 500, 100e3};
}

}  // namespace couplet::solid
