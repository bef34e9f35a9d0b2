#include "coupler/acceleration/constant_relaxation.hpp"

#include <utility>

namespace couplet::coupling {

ConstantRelaxation::ConstantRelaxation(Eigen::VectorXd factor) : factor_(std::move(factor)) {}

Eigen::VectorXd ConstantRelaxation::next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) {
  return input + factor_.cwiseProduct(output - input);
}

}  // namespace couplet::coupling
