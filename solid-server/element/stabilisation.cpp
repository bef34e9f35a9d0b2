#include "solid-server/element/stabilisation.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace couplet::solid::stabilisation {

namespace {

/// The value of each mode at each node.
Eigen::Matrix<double, n_modes, 8> mode_at_node() {
  Eigen::Matrix<double, n_modes, 8> value;
  const auto& coordinate = topology(ElementShape::hexahedron8).coordinate;
  for (Eigen::Index m = 0; m < n_modes; ++m)
    for (Eigen::Index a = 0; a < 8; ++a) {
      value(m, a) = 1;
      for (std::size_t k = 0; k < 3; ++k)
        if (mode_axes[static_cast<std::size_t>(m)] & (1 << k))
          value(m, a) *= coordinate[static_cast<std::size_t>(a)][k];
    }
  return value;
}

/// (products of the columns)^(-1/2) for two vectors:  sqrt(S) = (S + sqrt(det S) I) / sqrt(tr S + 2 sqrt(det S)).
Eigen::Matrix2d inverse_root_of_products(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Matrix2d S{{a.dot(a), a.dot(b)}, {a.dot(b), b.dot(b)}};
  const double root = a.cross(b).norm();
  return (S + root * Eigen::Matrix2d::Identity()).inverse() * std::sqrt(S.trace() + 2 * root);
}

/// Torsional stiffness of a rectangle of half sides a >= b, a b^3 (16/3 - 3.36 b/a (1 - (b/a)^4/12)) mu, over that of a
/// linear twist with linear warping, 16/3 a^3 b^3/(a^2 + b^2) mu.
double twist_factor(std::array<double, 3> half_side) {
  std::sort(half_side.begin(), half_side.end());
  const double r = half_side[0] / half_side[1];
  return (1 + r * r) * (1 - 0.63 * r * (1 - r * r * r * r / 12));
}

}  // namespace

std::array<double, n_geometry> geometry(const ElementVectors& position) {
  // The integrand dN_a/dX det(dX/dxi) has degree 2 in each direction: 2 x 2 x 2 points are exact.
  Eigen::Matrix<double, 8, 3> gradient = Eigen::Matrix<double, 8, 3>::Zero();
  double volume = 0;
  for (const QuadraturePoint& point : element_quadrature(ElementShape::hexahedron8, 8)) {
    const ReferencePoint reference = reference_point(ElementShape::hexahedron8, position, point);
    gradient += reference.volume * reference.gradient;
    volume += reference.volume;
  }
  gradient /= volume;

  using Modes = Eigen::Matrix<double, n_modes, 3, Eigen::RowMajor>;
  const auto modes = mode_at_node();
  const Modes B = modes * gradient, X = modes * position / 8;
  std::array<double, n_geometry> out{};
  std::copy_n(B.data(), B.size(), &out[gradient_at]);
  std::copy_n(X.data(), X.size(), &out[position_at]);
  std::array<double, 3> half_side{};
  for (int c = 0; c < 3; ++c) {
    const Eigen::Matrix2d A = inverse_root_of_products(X.row(first_other(c)), X.row(second_other(c)));
    const auto at = static_cast<std::size_t>(frame_at + 3 * c);
    out[at] = A(0, 0), out[at + 1] = A(0, 1), out[at + 2] = A(1, 1);
    const auto axis = static_cast<std::size_t>(c);
    half_side[axis] = X.row(c).norm();
    out[highest_at + axis] = volume / 9 / std::pow(half_side[axis], 4);
  }
  out[volume_at] = volume;
  out[twist_at] = twist_factor(half_side);
  return out;
}

}  // namespace couplet::solid::stabilisation
