#include "coupler/acceleration/iqn_imvj.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "coupler/acceleration/least_squares.hpp"

namespace couplet::coupling {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd with_front(const VectorXd& column, const MatrixXd& others, Index n_kept) {
  MatrixXd grown(column.size(), n_kept + 1);
  grown << column, others.leftCols(n_kept);
  return grown;
}

}  // namespace

IqnImvj::IqnImvj(InterfaceSize size, QuasiNewtonOptions options)
    : size_(size), options_(options), added_mass_(options.first_relaxation) {}

void IqnImvj::start_step() {
  has_previous_ = false;
  attempt_ = {MatrixXd(size_.n_total, 0), MatrixXd(size_.n_total, 0)};
  relaxation_ = steps_.empty() ? added_mass_.relaxation() : options_.first_relaxation.value_or(1);
}

VectorXd IqnImvj::next_input(const VectorXd& input, const VectorXd& output) {
  const VectorXd residual = output - input;
  learn(input, residual);
  const Update update = make_update(attempt_);
  return input + carried(residual) - update.correction * (update.dual.transpose() * residual.head(size_.n_primary));
}

void IqnImvj::accept_step(const VectorXd& input, const VectorXd& output) {
  learn(input, output - input);
  if (attempt_.residual.cols() > 0) {
    updates_.push_back(make_update(attempt_));
    steps_.push_back(std::move(attempt_));
  }
  Index n_columns = 0;
  for (const Differences& step : steps_) n_columns += step.residual.cols();
  if (n_columns > options_.columns_max) forget_older_half();
  start_step();
}

void IqnImvj::discard_step() {
  steps_.clear();
  updates_.clear();
  added_mass_.doubt();
  start_step();
}

void IqnImvj::learn(const VectorXd& input, const VectorXd& residual) {
  if (has_previous_) {
    const VectorXd difference = input - previous_input_;
    const VectorXd change = residual - previous_residual_;
    if (change.head(size_.n_primary).squaredNorm() > 0) {
      added_mass_.learn(difference.head(size_.n_primary), change.head(size_.n_primary));
      const Index n_kept = std::min(attempt_.residual.cols(), options_.columns_max - 1);
      attempt_ = {with_front(difference, attempt_.input, n_kept), with_front(change, attempt_.residual, n_kept)};
      relaxation_ =
          options_.first_relaxation.value_or(1);  // what no difference explains is hardly answered by the fluid
    }
  }
  has_previous_ = true;
  previous_input_ = input;
  previous_residual_ = residual;
}

VectorXd IqnImvj::carried(const VectorXd& residual) const {
  VectorXd step = relaxation_ * residual;
  for (const Update& update : updates_) {
    step.noalias() -= update.correction * (update.dual.transpose() * residual.head(size_.n_primary));
  }
  return step;
}

IqnImvj::Update IqnImvj::make_update(const Differences& step) const {
  const TriangularFactor factor = factorise(step.residual.topRows(size_.n_primary), options_.filter);
  Update update;
  update.correction.resize(size_.n_total, static_cast<Index>(factor.kept.size()));
  for (std::size_t k = 0; k < factor.kept.size(); ++k) {
    // X - K_before V
    update.correction.col(static_cast<Index>(k)) =
        step.input.col(factor.kept[k]) + carried(step.residual.col(factor.kept[k]));
  }
  // Z^T = R^{-1} Q^T, so Z = Q R^{-T}.
  update.dual = factor.triangle.triangularView<Eigen::Upper>().solve(factor.basis.transpose()).transpose();
  return update;
}

void IqnImvj::forget_older_half() {
  Index n_columns = 0;
  for (const Differences& step : steps_) n_columns += step.residual.cols();
  while (n_columns > options_.columns_max / 2 && steps_.size() > 1) {
    n_columns -= steps_.front().residual.cols();
    steps_.pop_front();
  }
  updates_.clear();
  relaxation_ = options_.first_relaxation.value_or(1);
  for (const Differences& step : steps_) updates_.push_back(make_update(step));
}

void IqnImvj::save(SavedState& state) const {
  added_mass_.save(state);
  state["n_steps"] = to_array({static_cast<double>(steps_.size())});
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    const std::string name = "step_" + std::to_string(k);
    state[name + ".input"] = steps_[k].input;
    state[name + ".residual"] = steps_[k].residual;
    state[name + ".correction"] = updates_[k].correction;
    state[name + ".dual"] = updates_[k].dual;
  }
}

void IqnImvj::restore(const SavedState& state) {
  added_mass_.restore(state);
  steps_.clear();
  updates_.clear();
  const auto n_steps = static_cast<std::size_t>(state.at("n_steps")(0));
  for (std::size_t k = 0; k < n_steps; ++k) {
    const std::string name = "step_" + std::to_string(k);
    steps_.push_back({state.at(name + ".input"), state.at(name + ".residual")});
    updates_.push_back({state.at(name + ".correction"), state.at(name + ".dual")});
  }
  start_step();
}

}  // namespace couplet::coupling
