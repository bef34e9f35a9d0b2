#include "coupler/acceleration/iqn_ils.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "coupler/acceleration/least_squares.hpp"

namespace couplet::coupling {

IqnIls::IqnIls(InterfaceSize size, QuasiNewtonOptions options)
    : size_(size),
      options_(options),
      added_mass_(options.first_relaxation),
      residual_differences_(size.n_primary, options.columns_max),
      input_differences_(size.n_total, 0),
      secondary_differences_(size.n_total - size.n_primary, 0) {}

void IqnIls::start_step() {
  has_previous_ = false;
}

Eigen::VectorXd IqnIls::next_input(const Eigen::VectorXd& input, const Eigen::VectorXd& output) {
  const Eigen::VectorXd residual = output - input;
  const Eigen::VectorXd projected = learn(input, residual);

  const TriangularFactor factor = factorise(residual_differences_.coefficients(), options_.filter);
  keep(factor.kept);
  const Eigen::VectorXd alpha = minimise(factor, projected);

  Eigen::VectorXd unexplained = residual;  // r + V alpha
  Eigen::VectorXd slot_weights = Eigen::VectorXd::Zero(input_differences_.cols());
  for (std::size_t k = 0; k < slot_.size(); ++k) slot_weights(slot_[k]) = alpha(static_cast<Eigen::Index>(k));
  residual_differences_.add_combination(residual_differences_.coefficients() * alpha,
                                        unexplained.head(size_.n_primary));
  unexplained.tail(secondary_differences_.rows()).noalias() += secondary_differences_ * slot_weights;

  const double relaxation = choose_relaxation(residual, unexplained);
  Eigen::VectorXd next = input + relaxation * unexplained;
  next.noalias() += input_differences_ * slot_weights;
  relaxed_ = std::move(unexplained);
  relaxation_of_relaxed_ = relaxation;
  return next;
}

// The unexplained part u was relaxed by omega, the rest solved; what is left, r, tells how u was answered:
//   rho = -u.(r - u) / (omega u.u)  is 1 + mu in the direction of u.
// 1/rho would solve that direction, 1 suits the many directions that the fluid hardly answers; the geometric mean
// reaches the end of the first step soonest. Differences of earlier steps leave only directions of the second kind.
double IqnIls::choose_relaxation(const Eigen::VectorXd& residual, const Eigen::VectorXd& unexplained) const {
  if (options_.first_relaxation) return *options_.first_relaxation;
  if (slot_.empty()) return added_mass_.relaxation();
  if (age_.back() > 0 || relaxed_.size() == 0) return 1;
  const auto u = relaxed_.head(size_.n_primary);
  const double squared = u.squaredNorm();
  if (!(squared > 0)) return 1;
  const double rho = -u.dot(residual.head(size_.n_primary) - u) / (relaxation_of_relaxed_ * squared);
  if (!(rho > 1)) return 1;
  const bool has_grown = unexplained.head(size_.n_primary).squaredNorm() > squared;
  return has_grown ? 1 / rho : 1 / std::sqrt(rho);
}

void IqnIls::accept_step(const Eigen::VectorXd& input, const Eigen::VectorXd& output) {
  learn(input, output - input);
  has_previous_ = false;
  for (int& age : age_) ++age;
  std::vector<Eigen::Index> young;
  for (std::size_t k = 0; k < age_.size(); ++k) {
    if (age_[k] <= options_.steps_reused) young.push_back(static_cast<Eigen::Index>(k));
  }
  keep(young);
}

void IqnIls::discard_step() {
  has_previous_ = false;
  keep({});
  added_mass_.doubt();
}

// Adds the differences to the iteration before. Returns Q^T r.
Eigen::VectorXd IqnIls::learn(const Eigen::VectorXd& input, const Eigen::VectorXd& residual) {
  const auto primary = residual.head(size_.n_primary);
  Eigen::VectorXd projected;
  const Eigen::VectorXd difference = has_previous_ ? Eigen::VectorXd(input - previous_input_) : Eigen::VectorXd();
  const Eigen::VectorXd change = has_previous_ ? Eigen::VectorXd(residual - previous_residual_) : Eigen::VectorXd();
  if (has_previous_ && change.head(size_.n_primary).squaredNorm() > 0) {
    added_mass_.learn(difference.head(size_.n_primary), change.head(size_.n_primary));
    if (static_cast<Eigen::Index>(slot_.size()) == options_.columns_max) {
      std::vector<Eigen::Index> newest(slot_.size() - 1);
      std::iota(newest.begin(), newest.end(), 0);
      keep(newest);
    }
    projected = residual_differences_.add(change.head(size_.n_primary), primary);
    const Eigen::Index slot = free_slot();
    input_differences_.col(slot) = difference;
    secondary_differences_.col(slot) = change.tail(secondary_differences_.rows());
    slot_.insert(slot_.begin(), slot);
    age_.insert(age_.begin(), 0);
  } else {
    projected = residual_differences_.project(primary);
  }
  has_previous_ = true;
  previous_input_ = input;
  previous_residual_ = residual;
  return projected;
}

void IqnIls::keep(const std::vector<Eigen::Index>& columns) {
  if (columns.size() == slot_.size()) return;
  residual_differences_.keep(columns);
  std::vector<Eigen::Index> slot;
  std::vector<int> age;
  for (const Eigen::Index column : columns) {
    slot.push_back(slot_[static_cast<std::size_t>(column)]);
    age.push_back(age_[static_cast<std::size_t>(column)]);
  }
  slot_ = std::move(slot);
  age_ = std::move(age);
}

Eigen::Index IqnIls::free_slot() {
  for (Eigen::Index slot = 0; slot < input_differences_.cols(); ++slot) {
    if (std::find(slot_.begin(), slot_.end(), slot) == slot_.end()) return slot;
  }
  const Eigen::Index n_old = input_differences_.cols();
  const Eigen::Index n_new = std::min(options_.columns_max, std::max<Eigen::Index>(8, 2 * n_old));
  input_differences_.conservativeResize(size_.n_total, n_new);
  secondary_differences_.conservativeResize(size_.n_total - size_.n_primary, n_new);
  input_differences_.rightCols(n_new - n_old).setZero();
  secondary_differences_.rightCols(n_new - n_old).setZero();
  return n_old;
}

void IqnIls::save(SavedState& state) const {
  added_mass_.save(state);
  residual_differences_.save(state, "residual_differences");
  state["input_differences"] = input_differences_;
  state["secondary_differences"] = secondary_differences_;
  Eigen::MatrixXd columns(2, static_cast<Eigen::Index>(slot_.size()));
  for (std::size_t k = 0; k < slot_.size(); ++k) {
    columns.col(static_cast<Eigen::Index>(k)) << static_cast<double>(slot_[k]), age_[k];
  }
  state["columns"] = columns;
}

void IqnIls::restore(const SavedState& state) {
  added_mass_.restore(state);
  residual_differences_.restore(state, "residual_differences");
  input_differences_ = state.at("input_differences");
  secondary_differences_ = state.at("secondary_differences");
  const Eigen::MatrixXd& columns = state.at("columns");
  slot_.clear(), age_.clear();
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    slot_.push_back(static_cast<Eigen::Index>(columns(0, k)));
    age_.push_back(static_cast<int>(columns(1, k)));
  }
  has_previous_ = false;
}

}  // namespace couplet::coupling
