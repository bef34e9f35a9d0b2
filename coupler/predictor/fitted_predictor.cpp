#include "coupler/predictor/fitted_predictor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

namespace couplet::coupling {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index n_weights = 4;       // differences that a fitted prediction is made of
constexpr Index n_equations = 4;     // past steps that the weights are fitted to
constexpr double forgetting = 0.25;  // weight of a past step over that of the step after it
constexpr int polynomial_order = 2;
constexpr double uniform = 1e-6;       // relative difference between steps that count as equal
constexpr double independent = 1e-12;  // smaller eigenvalues of the normal matrix are rounding errors of squares

}  // namespace

FittedPredictor::FittedPredictor(Index n_primary)
    : n_primary_(n_primary), history_(static_cast<std::size_t>(n_weights + n_equations)), gram_(0, 0) {}

void FittedPredictor::accept(double time, const VectorXd& state) {
  if (history_.times().empty()) return history_.accept(time, state);
  const std::vector<VectorXd> tried = candidates(time);
  const VectorXd difference = (state - history_.last()).head(n_primary_);
  const Index n_old = history_.n_differences();
  VectorXd projections(n_old);
  for (Index i = 0; i < n_old; ++i) projections(i) = difference.dot(history_.difference(i).head(n_primary_));
  const double squared_norm = difference.squaredNorm();
  judge(tried, projections, squared_norm);

  history_.accept(time, state);
  const Index n = history_.n_differences();
  MatrixXd gram(n, n);
  gram(0, 0) = squared_norm;
  gram.col(0).tail(n - 1) = projections.head(n - 1);
  gram.row(0).tail(n - 1) = projections.head(n - 1).transpose();
  gram.bottomRightCorner(n - 1, n - 1) = gram_.topLeftCorner(n - 1, n - 1);
  gram_ = std::move(gram);
}

VectorXd FittedPredictor::predict(double time) const {
  const std::vector<VectorXd> possible = candidates(time);
  return history_.combine(possible[std::min(best_, possible.size() - 1)]);
}

// |d - sum c_i d_i|^2 = d.d - 2 sum c_i d.d_i + sum c_i c_j d_i.d_j.
void FittedPredictor::judge(const std::vector<VectorXd>& candidates, const VectorXd& projections, double squared_norm) {
  double smallest = INFINITY;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const VectorXd& c = candidates[k];
    const Index n = c.size();
    const double error = squared_norm - 2 * c.dot(projections.head(n)) + c.dot(gram_.topLeftCorner(n, n) * c);
    if (error < smallest) smallest = error, best_ = k;
  }
  // A candidate that becomes possible only now has not failed yet: the highest one is given its chance.
  if (best_ + 1 == candidates.size() && candidates.size() <= polynomial_order) ++best_;
}

std::vector<VectorXd> FittedPredictor::candidates(double time) const {
  std::vector<VectorXd> possible;
  for (int order = 0; order <= std::min<Index>(polynomial_order, history_.n_differences()); ++order) {
    possible.push_back(history_.polynomial(order, time));
  }
  if (history_.n_differences() >= n_weights + 2 && is_uniform(time)) possible.push_back(fit());
  return possible;
}

bool FittedPredictor::is_uniform(double time) const {
  const std::vector<double>& times = history_.times();
  const double step = time - times[0];
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    if (std::abs(times[i] - times[i + 1] - step) > uniform * step) return false;
  }
  return true;
}

// Normal equations of d_r = sum_i c_i d_{r+1+i} for the past steps r, all from the Gram matrix of the differences.
VectorXd FittedPredictor::fit() const {
  const Index n_rows = std::min(n_equations, history_.n_differences() - n_weights);
  MatrixXd matrix = MatrixXd::Zero(n_weights, n_weights);
  VectorXd rhs = VectorXd::Zero(n_weights);
  double weight = 1;
  for (Index r = 0; r < n_rows; ++r, weight *= forgetting) {
    matrix += weight * gram_.block(r + 1, r + 1, n_weights, n_weights);
    rhs += weight * gram_.col(r).segment(r + 1, n_weights);
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(matrix);
  const double cut = independent * eigen.eigenvalues().maxCoeff();
  VectorXd c = VectorXd::Zero(n_weights);
  for (Index k = 0; k < n_weights; ++k) {
    if (!(eigen.eigenvalues()(k) > cut)) continue;
    const auto direction = eigen.eigenvectors().col(k);
    c += direction * (direction.dot(rhs) / eigen.eigenvalues()(k));
  }
  return c;
}

void FittedPredictor::save(SavedState& state, const std::string& name) const {
  history_.save(state, name);
  state[name + ".gram"] = gram_;
  state[name + ".best"] = to_array({static_cast<double>(best_)});
}

void FittedPredictor::restore(const SavedState& state, const std::string& name) {
  history_.restore(state, name);
  gram_ = state.at(name + ".gram");
  best_ = static_cast<std::size_t>(state.at(name + ".best")(0));
}

}  // namespace couplet::coupling
