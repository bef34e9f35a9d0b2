#include "solid-server/assembly/minimal_residual.hpp"

#include <Eigen/QR>
#include <vector>

namespace couplet::solid {

NodeVectors minimal_residual(const LinearMap& multiply, const LinearMap& solve_nearby, const NodeVectors& b,
                             double tolerance, int n_most) {
  const auto dot = [](const NodeVectors& x, const NodeVectors& y) { return x.cwiseProduct(y).sum(); };
  NodeVectors x = solve_nearby(b);
  const double size = x.norm();
  if (!(size > 0)) return x;
  std::vector<NodeVectors> basis{x / size};                       // of the Krylov space, orthonormal
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n_most + 1, n_most);  // P^-1 A basis = basis H
  Eigen::VectorXd y;
  for (int n = 0; n < n_most; ++n) {
    NodeVectors next = solve_nearby(multiply(basis.back()));
    for (int m = 0; m <= n; ++m) {
      H(m, n) = dot(basis[static_cast<std::size_t>(m)], next);
      next -= H(m, n) * basis[static_cast<std::size_t>(m)];
    }
    H(n + 1, n) = next.norm();
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n + 2);
    rhs[0] = size;
    const auto part = H.topLeftCorner(n + 2, n + 1);
    y = part.householderQr().solve(rhs);
    if ((rhs - part * y).norm() <= tolerance * size || !(H(n + 1, n) > 0)) break;
    basis.push_back(next / H(n + 1, n));
  }
  x.setZero();
  for (Eigen::Index m = 0; m < y.size(); ++m) x += y[m] * basis[static_cast<std::size_t>(m)];
  return x;
}

}  // namespace couplet::solid
