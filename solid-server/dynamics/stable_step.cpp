#include "solid-server/dynamics/stable_step.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr int n_steps_max = 60;
constexpr double wanted_accuracy = 0.001;       // of omega^2: half of that in the step
constexpr double relative_displacement = 1e-6;  // of the smallest length: round-off 1e-10, curvature 1e-6 of the result

/// Numbers between -1 and 1 that have nothing to do with any mode (Lehmer's generator).
NodeVectors scattered(Eigen::Index n_nodes) {
  NodeVectors values(n_nodes, 4);
  std::uint64_t seed = 48271;
  for (Eigen::Index n = 0; n < values.size(); ++n) {
    seed = seed * 48271 % 2147483647;
    values.data()[n] = 2.0 * static_cast<double>(seed) / 2147483647.0 - 1;
  }
  return values;
}

struct RitzValue {
  double value, residual;
};

RitzValue largest_ritz_value(const std::vector<double>& diagonal, const std::vector<double>& beside) {
  const auto n = static_cast<Eigen::Index>(diagonal.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), n),
                                Eigen::Map<const Eigen::VectorXd>(beside.data(), n - 1));
  return {solver.eigenvalues()[n - 1], beside.back() * std::abs(solver.eigenvectors()(n - 1, n - 1))};
}

}  // namespace

double stable_step(const std::function<NodeVectors(const NodeVectors&)>& internal_force,
                   const NodeVectors& displacement, const NodeVectors& inverse_mass, double smallest_length,
                   double extra_rate_squared, double stiffness_damping) {
  const NodeVectors root = inverse_mass.cwiseSqrt();  // M^-1/2, 0 at supports
  const NodeVectors force = internal_force(displacement);
  const auto apply = [&](const NodeVectors& q) -> NodeVectors {
    const NodeVectors direction = root.cwiseProduct(q);
    const double scale = relative_displacement * smallest_length / direction.cwiseAbs().maxCoeff();
    return root.cwiseProduct(force - internal_force(displacement + scale * direction)) / scale;
  };

  NodeVectors q = scattered(displacement.rows()).cwiseProduct((root.array() > 0).cast<double>().matrix());
  if (q.norm() == 0) throw report::SceneError("solid", "no node of any body is free to move", "fix fewer surfaces");
  q /= q.norm();
  NodeVectors before = NodeVectors::Zero(q.rows(), 4);
  std::vector<double> diagonal, beside;
  RitzValue largest{};
  for (int step = 0; step < n_steps_max; ++step) {
    NodeVectors r = apply(q);
    if (step > 0) r -= beside.back() * before;
    diagonal.push_back(r.cwiseProduct(q).sum());
    r -= diagonal.back() * q;
    beside.push_back(r.norm());
    largest = largest_ritz_value(diagonal, beside);
    if (!(largest.residual > wanted_accuracy * largest.value)) break;
    before = q;
    q = r / beside.back();
  }
  const double rate_squared = largest.value + largest.residual + extra_rate_squared;
  if (!std::isfinite(rate_squared) || rate_squared <= 0)
    throw report::NumericsError("stable step", "the largest eigenvalue of the body is " + std::to_string(rate_squared),
                                "the body is badly deformed: check loads and time.step");
  const double rate = std::sqrt(rate_squared), zeta = stiffness_damping * rate / 2;
  return 2 / rate *
         (std::sqrt(1 + zeta * zeta) - zeta);  // the v of the half step lags [Belytschko, Liu, Moran 2000, ch. 6]
}

}  // namespace couplet::solid
