#include "coupler/acceleration/iqn_imvj.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "coupler/acceleration/least_squares.hpp"

namespace couplet::coupling {

using Eigen::MatrixXd;
using Eigen::VectorXd;

IqnImvj::IqnImvj(InterfaceSize size, QuasiNewtonOptions options)
    : size_(size), options_(options), added_mass_(options.first_relaxation) {}

void IqnImvj::start_step() {
  has_previous_ = false;
  residual_differences_.resize(size_.n_primary, 0);
  corrections_.resize(size_.n_total, 0);
  relaxation_ = updates_.empty() ? added_mass_.relaxation() : 1;
}

VectorXd IqnImvj::next_input(const VectorXd& input, const VectorXd& output) {
  const VectorXd residual = output - input;
  learn(input, residual);
  const Update update = make_update();
  return input + carried(residual) - update.correction * (update.dual.transpose() * residual.head(size_.n_primary));
}

void IqnImvj::accept_step(const VectorXd& input, const VectorXd& output) {
  learn(input, output - input);
  if (residual_differences_.cols() > 0) updates_.push_back(make_update());
  Eigen::Index n_columns = 0;
  for (const Update& update : updates_) n_columns += update.dual.cols();
  while (n_columns > options_.columns_max && updates_.size() > 1) {
    n_columns -= updates_.front().dual.cols();
    updates_.pop_front();
  }
  start_step();
}

void IqnImvj::discard_step() {
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
      if (updates_.empty() && residual_differences_.cols() == 0) relaxation_ = 1;
      const Eigen::Index n_kept = std::min(residual_differences_.cols(), options_.columns_max - 1);
      MatrixXd differences(size_.n_primary, n_kept + 1), corrections(size_.n_total, n_kept + 1);
      differences << change.head(size_.n_primary), residual_differences_.leftCols(n_kept);
      corrections << difference + carried(change), corrections_.leftCols(n_kept);
      residual_differences_ = std::move(differences);
      corrections_ = std::move(corrections);
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

IqnImvj::Update IqnImvj::make_update() {
  const TriangularFactor factor = factorise(residual_differences_, options_.filter);
  Update update;
  update.correction.resize(size_.n_total, static_cast<Eigen::Index>(factor.kept.size()));
  for (std::size_t k = 0; k < factor.kept.size(); ++k) {
    update.correction.col(static_cast<Eigen::Index>(k)) = corrections_.col(factor.kept[k]);
  }
  // Z^T = R^{-1} Q^T, so Z = Q R^{-T}.
  update.dual = factor.triangle.triangularView<Eigen::Upper>().solve(factor.basis.transpose()).transpose();
  return update;
}

void IqnImvj::save(SavedState& state) const {
  added_mass_.save(state);
  state["n_updates"] = to_array({static_cast<double>(updates_.size())});
  for (std::size_t k = 0; k < updates_.size(); ++k) {
    state["update." + std::to_string(k) + ".correction"] = updates_[k].correction;
    state["update." + std::to_string(k) + ".dual"] = updates_[k].dual;
  }
}

void IqnImvj::restore(const SavedState& state) {
  added_mass_.restore(state);
  updates_.clear();
  const auto n_updates = static_cast<std::size_t>(state.at("n_updates")(0));
  for (std::size_t k = 0; k < n_updates; ++k) {
    const std::string name = "update." + std::to_string(k);
    updates_.push_back({state.at(name + ".correction"), state.at(name + ".dual")});
  }
  start_step();
}

}  // namespace couplet::coupling
