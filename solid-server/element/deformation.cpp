#include "solid-server/element/deformation.hpp"

#include <Eigen/LU>

namespace couplet::solid {

ReferencePoint reference_point(ElementShape shape, const ElementVectors& position, const QuadraturePoint& point) {
  const auto natural = shape_gradient(shape, point.xi);
  const Eigen::Matrix3d jacobian = position.transpose() * natural;  // dX_J/dxi_k, (J, k)
  ReferencePoint out;
  out.inverse_jacobian = jacobian.inverse();
  out.volume = jacobian.determinant() * point.weight;
  out.gradient = natural * out.inverse_jacobian;
  return out;
}

std::vector<TabulatedPoint> tabulate(ElementShape shape, const std::vector<QuadraturePoint>& points) {
  std::vector<TabulatedPoint> table;
  for (const QuadraturePoint& point : points)
    table.push_back({point.weight, shape_values(shape, point.xi), shape_gradient(shape, point.xi)});
  return table;
}

Eigen::Matrix3d jacobian(const ElementVectors& position, const TabulatedPoint& point) {
  return position.transpose().lazyProduct(point.natural_gradient);
}

Tensor<double> deformation_gradient(const ElementVectors& displacement, const ReferencePoint& point) {
  const Eigen::Matrix3d gradient = displacement.transpose() * point.gradient;
  Tensor<double> F;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) F.at[i][j] = gradient(i, j) + (i == j ? 1 : 0);
  return F;
}

}  // namespace couplet::solid
