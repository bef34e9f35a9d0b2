#include "flow-server/poisson/multigrid_solver.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "flow-server/poisson/solve_checks.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

constexpr int stagnation_iterations = 12;  // that many without any progress end a solve

/// Sums over ranks depend on their number in the last digits. Rounded to single precision their quotients do not, and
/// neither does anything that is computed from them: all ranks, however many, go the same way.
double rounded(double quotient) {
  return static_cast<double>(static_cast<float>(quotient));
}

}  // namespace

MultigridSolver::MultigridSolver(const PressureProblem& problem)
    : problem_(problem),
      decomposition_(problem.decomposition),
      halo_(*problem.decomposition),
      residual_(problem.decomposition->mine().sizes(), {0, 0, 0}) {
  Triple layer;
  for (int d = 0; d < 3; ++d) layer[d] = d < problem.grid->n_dimensions;
  direction_ = Field<float>(problem.decomposition->mine().sizes(), layer);
  make_solver();
}

void MultigridSolver::make_solver() {
  operator_ = std::make_unique<PressureOperator>(problem_);
  piece_operator_ = problem_.split ? std::make_unique<PieceOperator>(problem_, *operator_) : nullptr;
  multigrid_ = std::make_unique<Multigrid>(problem_);
  find_parts();
}

void MultigridSolver::find_parts() {
  const double on_this_rank = operator_->volume() + (piece_operator_ ? piece_operator_->volume() : 0);
  const bool is_open = !problem_.open_share && operator_->has_open_border();  // else its parts tell
  const auto [volume, n_open] = sum_over_ranks<2>({on_this_rank, is_open ? 1.0 : 0.0});
  volume_ = volume;
  is_singular_ = n_open == 0;
  n_sealed_ = 0;
  if (!problem_.open_share) return;
  const Multigrid::Parts parts = multigrid_->number_parts();
  is_singular_ = parts.n == 1 && parts.n_sealed == 1;
  if (parts.n_sealed == 0 || is_singular_) return;
  n_sealed_ = parts.n_sealed;
  const Triple sizes = decomposition_->mine().sizes();
  if (part_.is_empty()) part_ = Field<float>(sizes, {0, 0, 0});
  if (balanced_source_.is_empty()) balanced_source_ = Field<double>(sizes, {0, 0, 0});
  operator_->copy(multigrid_->correction(), part_);
  piece_part_ = multigrid_->piece_correction();
  part_volume_.assign(static_cast<std::size_t>(n_sealed_), 0.0);
  operator_->add_parts(part_, nullptr, part_volume_);
  if (piece_operator_) piece_operator_->add_parts(piece_part_, {}, part_volume_);
  sum_over_ranks(part_volume_);
}

void MultigridSolver::update(std::span<const Box> changed) {
  if (piece_operator_) last_traffic_ += piece_operator_->traffic();
  if (problem_.split.has_value() != (piece_operator_ != nullptr)) {
    last_traffic_ += multigrid_->traffic();
    make_solver();
    return;
  }
  operator_->update(problem_, changed);
  if (problem_.split) piece_operator_ = std::make_unique<PieceOperator>(problem_, *operator_);
  multigrid_->update(problem_, changed);
  find_parts();
}

template <std::size_t n>
std::array<double, n> MultigridSolver::sum_over_ranks(std::array<double, n> sums) {
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(n), MPI_DOUBLE, MPI_SUM, decomposition_->communicator());
  ++reductions_.reductions;
  return sums;
}

void MultigridSolver::sum_over_ranks(std::vector<double>& sums) {
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                decomposition_->communicator());
  ++reductions_.reductions;
}

double MultigridSolver::remove_means(Field<double>& values, std::span<double> piece_values) {
  std::vector<double> mean(static_cast<std::size_t>(n_sealed_), 0.0);
  operator_->add_parts(part_, &values, mean);
  std::array<double, 2> own = operator_->moments(values);
  if (piece_operator_) {
    piece_operator_->add_parts(piece_part_, piece_values, mean);
    own[1] += piece_operator_->moments(piece_values)[1];
  }
  sum_over_ranks(mean);
  const double norm = std::sqrt(sum_over_ranks(own)[1] / volume_);
  double largest = 0;
  for (std::size_t part = 0; part < mean.size(); ++part) {
    largest = std::max(largest, std::abs(mean[part]));
    mean[part] = rounded_mean(mean[part] / part_volume_[part], norm);
  }
  operator_->subtract_parts(part_, mean, values);
  for (std::size_t p = 0; p < piece_part_.size(); ++p)
    if (piece_part_[p] > 0) piece_values[p] -= mean[static_cast<std::size_t>(piece_part_[p]) - 1];
  return largest;
}

SolveReport MultigridSolver::solve(const Field<double>& given_source, Field<double>& phi, const SolveLimits& limits,
                                   std::span<const double> given_piece_source, std::span<double> piece_phi) {
  SolveReport report;
  if (const std::size_t n = problem_.split ? problem_.split->cell.size() : 0;
      given_piece_source.size() != n || piece_phi.size() != n)
    throw couplet::report::NumericsError("pressure",
                                         "sources and pressures of " + std::to_string(given_piece_source.size()) +
                                             " further pieces were given, cells are split into " + std::to_string(n),
                                         "call update() after each change of the split cells");
  const Field<double>& source = n_sealed_ > 0 ? balanced_source_ : given_source;
  pieces_.source.assign(given_piece_source.begin(), given_piece_source.end());
  const std::span<const double> piece_source = pieces_.source;
  if (n_sealed_ > 0) {
    operator_->subtract_to(given_source, 0, balanced_source_);
    report.largest_defect = remove_means(balanced_source_, pieces_.source);
  }
  clear_ghosts_beyond_borders(*decomposition_, phi);
  halo_.exchange<double>({&phi}, 1);
  PieceOperator* const split = piece_operator_.get();
  const auto n_pieces = static_cast<std::size_t>(split ? split->n_pieces() : 0);
  pieces_.phi.assign(piece_phi.begin(), piece_phi.end());
  pieces_.residual.assign(n_pieces, 0.0);
  pieces_.direction.assign(n_pieces, 0.0f);
  std::array<double, 2> own_moments = operator_->moments(source);
  if (split) {
    split->exchange(pieces_.phi);
    const auto [first, second] = split->moments(piece_source);
    own_moments[0] += first, own_moments[1] += second;
  }
  const std::array<double, 2> moments = sum_over_ranks(own_moments);
  double source_norm = std::sqrt(moments[1] / volume_);
  if (is_singular_) {
    report.removed_mean = rounded_mean(moments[0] / volume_, source_norm);
    source_norm = std::sqrt(std::max(0.0, moments[1] / volume_ - report.removed_mean * report.removed_mean));
    report.largest_defect = std::abs(moments[0]);
  }
  report.source_norm = source_norm;
  const auto norm_of = [&](double squares) { return std::sqrt(sum_over_ranks<1>({squares})[0] / volume_); };
  const auto norm_of_residual = [&](Field<double>* residual) {
    double squares = operator_->residual(source, report.removed_mean, phi, residual, pieces_.phi);
    if (split) squares += split->residual(piece_source, report.removed_mean, phi, pieces_.phi, pieces_.residual);
    return norm_of(squares);
  };
  double norm = norm_of_residual(&residual_);
  refuse_unless_finite(norm);
  const double enough = std::max(limits.relative * source_norm, limits.absolute);
  if (source_norm == 0 && norm > enough) {
    // Without a source the answer is known.
    // What is 0 already is not touched: cells without fluid take no memory.
    std::for_each(phi.data(), phi.data() + phi.n_values(), [](double& value) {
      if (value != 0) value = 0;
    });
    std::fill(pieces_.phi.begin(), pieces_.phi.end(), 0.0);
    norm = norm_of_residual(&residual_);
  }
  const double first_norm = norm;
  double least = norm, last_squares = 0;  // <p, A p>
  int since_least = 0;
  if (norm > enough) {
    operator_->copy(residual_, multigrid_->rhs());
    std::transform(pieces_.residual.begin(), pieces_.residual.end(), multigrid_->piece_rhs().begin(),
                   [](double value) { return static_cast<float>(value); });
  }
  while (norm > enough && report.iterations < limits.largest_iterations) {
    multigrid_->cycle();
    const Field<float>& z = multigrid_->correction();
    const std::vector<float>& piece_z = multigrid_->piece_correction();
    DirectionSums sums = operator_->direction_sums(z, residual_, direction_);
    if (split) sums += split->direction_sums(z, piece_z, pieces_.residual, direction_, pieces_.direction);
    const auto [zr, zaz, zap] =
        sum_over_ranks<3>({sums.correction_residual, sums.correction_operator, sums.correction_conjugate});
    // p = z + beta p with <p, A p_last> = 0; then alpha = <r, p> / <p, A p>, where <r, p_last> = 0 and <p, A p> follows
    // from the sums at hand.
    const double beta = report.iterations == 0 ? 0 : rounded(-zap / last_squares);
    const double squares = zaz + 2 * beta * zap + beta * beta * last_squares;
    const double alpha = rounded(zr / squares);
    if (split) split->turn(piece_z, beta, pieces_.direction);
    double left = operator_->advance(z, beta, alpha, direction_, phi, residual_, multigrid_->rhs(), pieces_.direction);
    if (split)
      left +=
          split->advance(alpha, direction_, pieces_.direction, pieces_.phi, pieces_.residual, multigrid_->piece_rhs());
    norm = norm_of(left);
    last_squares = squares;
    ++report.iterations;
    ++report.cycles;
    if (norm < 0.9 * least) {
      least = norm;
      since_least = 0;
    } else {
      ++since_least;
    }
    if (std::isfinite(norm) && since_least < stagnation_iterations) continue;
    refuse_residual(norm, first_norm, report.iterations, enough);
  }
  if (norm > enough) refuse_iterations(norm, report.iterations, enough);
  if (is_singular_) {
    std::array<double, 2> own = operator_->moments(phi);
    if (split) own[0] += split->moments(pieces_.phi)[0], own[1] += split->moments(pieces_.phi)[1];
    const auto [sum, sum_of_squares] = sum_over_ranks(own);
    const double mean = rounded_mean(sum / volume_, std::sqrt(sum_of_squares / volume_));
    operator_->subtract(mean, phi);
    for (double& value : pieces_.phi) value -= mean;
  }
  if (n_sealed_ > 0) remove_means(phi, pieces_.phi);
  halo_.exchange<double>({&phi}, 1);
  if (split) split->exchange(pieces_.phi);
  report.true_residual = report.iterations == 0 ? norm : norm_of_residual(nullptr);
  std::copy(pieces_.phi.begin(), pieces_.phi.end(), piece_phi.begin());
  return report;
}

std::size_t MultigridSolver::n_bytes() const {
  const std::size_t n_of_pieces =
      (pieces_.phi.size() + pieces_.residual.size()) * sizeof(double) + pieces_.direction.size() * sizeof(float);
  return multigrid_->n_bytes() + residual_.n_bytes() + direction_.n_bytes() + n_of_pieces;
}

Traffic MultigridSolver::traffic() const {
  Traffic sum = multigrid_->traffic();
  if (piece_operator_) sum += piece_operator_->traffic();
  sum += last_traffic_;
  sum += halo_.traffic();
  sum += reductions_;
  return sum;
}

}  // namespace couplet::flow
