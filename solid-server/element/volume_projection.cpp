#include "solid-server/element/volume_projection.hpp"

#include <Eigen/Cholesky>

namespace couplet::solid {

Eigen::VectorXd volume_functions(ElementShape shape, const Eigen::Vector3d& xi) {
  Eigen::VectorXd phi(n_volume_functions(topology(shape).n_nodes));
  phi[0] = 1;
  if (phi.size() > 1) phi.tail<3>() = xi;
  return phi;
}

std::vector<double> inverse_gram_matrix(ElementShape shape, const std::vector<QuadraturePoint>& points,
                                        const std::vector<double>& volume) {
  const Eigen::Index n = n_volume_functions(topology(shape).n_nodes);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Eigen::VectorXd phi = volume_functions(shape, points[q].xi);
    gram += volume[q] * phi * phi.transpose();
  }
  const Eigen::MatrixXd inverse = gram.llt().solve(Eigen::MatrixXd::Identity(n, n));
  std::vector<double> upper;
  for (Eigen::Index A = 0; A < n; ++A)
    for (Eigen::Index B = A; B < n; ++B) upper.push_back(inverse(A, B));
  return upper;
}

}  // namespace couplet::solid
