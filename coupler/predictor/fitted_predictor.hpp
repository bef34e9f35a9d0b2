#pragma once
// A predictor that learns how the interface moves: linear prediction fitted to the recent past.

#include <vector>

#include "coupler/predictor/predictor.hpp"
#include "coupler/predictor/state_history.hpp"

namespace couplet::coupling {

/// The next difference is predicted as d_next = sum_{i < 4} c_i d_i. The weights c minimise, over the last four steps
/// with weights 1, 1/4, 1/16, 1/64, the squared error of the whole field: four numbers from thousands of equations. Two
/// oscillations of any frequency (or growth, or decay) on top of a constant are continued exactly, which no polynomial
/// does. [Makhoul 1975, linear prediction by the covariance method, here for a field.]
///
/// Constant, linear and quadratic extrapolation stand by: whichever predicted the last accepted state best predicts the
/// next one. The fit needs equal steps; after a change of step the polynomials serve until the history is uniform
/// again.
class FittedPredictor : public Predictor {
 public:
  /// Only the first n_primary entries are fitted and compared; the others follow with the same weights.
  explicit FittedPredictor(Eigen::Index n_primary);

  void accept(double time, const Eigen::VectorXd& state) override;
  Eigen::VectorXd predict(double time) const override;
  const Eigen::VectorXd& last() const override { return history_.last(); }
  void save(SavedState& state, const std::string& name) const override;
  void restore(const SavedState& state, const std::string& name) override;

 private:
  /// Weights on the differences by each candidate that the history allows: constant, linear, quadratic, fitted.
  std::vector<Eigen::VectorXd> candidates(double time) const;
  bool is_uniform(double time) const;
  Eigen::VectorXd fit() const;
  void judge(const std::vector<Eigen::VectorXd>& candidates, const Eigen::VectorXd& projections, double squared_norm);

  Eigen::Index n_primary_;
  StateHistory history_;
  Eigen::MatrixXd gram_;  // (n_differences, n_differences): d_i . d_j over the primary entries
  std::size_t best_ = 0;  // candidate that predicted the last accepted state best
};

}  // namespace couplet::coupling
