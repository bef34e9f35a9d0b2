#pragma once
// Constant, linear and quadratic extrapolation.

#include "coupler/predictor/predictor.hpp"
#include "coupler/predictor/state_history.hpp"

namespace couplet::coupling {

/// The polynomial through the last order + 1 accepted states, of lower order while there are fewer. Order 0 holds the
/// last state.
class PolynomialPredictor : public Predictor {
 public:
  explicit PolynomialPredictor(int order) : order_(order), history_(static_cast<std::size_t>(order)) {}

  void accept(double time, const Eigen::VectorXd& state) override { history_.accept(time, state); }
  Eigen::VectorXd predict(double time) const override { return history_.combine(history_.polynomial(order_, time)); }
  const Eigen::VectorXd& last() const override { return history_.last(); }
  void save(SavedState& state, const std::string& name) const override { history_.save(state, name); }
  void restore(const SavedState& state, const std::string& name) override { history_.restore(state, name); }

 private:
  int order_;
  StateHistory history_;
};

}  // namespace couplet::coupling
