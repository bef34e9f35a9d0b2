#include "flow-server/poisson/multigrid_solver.hpp"

#include <algorithm>
#include <cmath>

#include "flow-server/poisson/solve_checks.hpp"

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
    : decomposition_(problem.decomposition),
      operator_(problem),
      multigrid_(problem),
      halo_(*problem.decomposition),
      residual_(problem.decomposition->mine().sizes(), {0, 0, 0}) {
  Triple layer;
  for (int d = 0; d < 3; ++d) layer[d] = d < problem.grid->n_dimensions;
  direction_ = Field<float>(problem.decomposition->mine().sizes(), layer);
  const auto [volume, n_open] = sum_over_ranks<2>({operator_.volume(), operator_.has_open_border() ? 1.0 : 0.0});
  volume_ = volume;
  is_singular_ = n_open == 0;
}

template <std::size_t n>
std::array<double, n> MultigridSolver::sum_over_ranks(std::array<double, n> sums) {
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(n), MPI_DOUBLE, MPI_SUM, decomposition_->communicator());
  ++reductions_.reductions;
  return sums;
}

SolveReport MultigridSolver::solve(const Field<double>& source, Field<double>& phi, const SolveLimits& limits) {
  SolveReport report;
  clear_ghosts_beyond_borders(*decomposition_, phi);
  halo_.exchange<double>({&phi}, 1);
  std::array<double, 2> moments = sum_over_ranks(operator_.moments(source));
  double source_norm = std::sqrt(moments[1] / volume_);
  if (is_singular_) {
    report.removed_mean = rounded_mean(moments[0] / volume_, source_norm);
    source_norm = std::sqrt(std::max(0.0, moments[1] / volume_ - report.removed_mean * report.removed_mean));
  }
  report.source_norm = source_norm;
  const auto norm_of = [&](double squares) { return std::sqrt(sum_over_ranks<1>({squares})[0] / volume_); };
  double norm = norm_of(operator_.residual(source, report.removed_mean, phi, &residual_));
  refuse_unless_finite(norm);
  const double enough = std::max(limits.relative * source_norm, limits.absolute);
  if (source_norm == 0 && norm > enough) {
    // Without a source the answer is known.
    std::fill(phi.data(), phi.data() + phi.n_values(), 0.0);
    norm = norm_of(operator_.residual(source, report.removed_mean, phi, &residual_));
  }
  const double first_norm = norm;
  double least = norm, last_squares = 0;  // <p, A p>
  int since_least = 0;
  if (norm > enough) operator_.copy(residual_, multigrid_.rhs());
  while (norm > enough && report.iterations < limits.largest_iterations) {
    multigrid_.cycle();
    const Field<float>& z = multigrid_.correction();
    const DirectionSums sums = operator_.direction_sums(z, residual_, direction_);
    const auto [zr, zaz, zap] =
        sum_over_ranks<3>({sums.correction_residual, sums.correction_operator, sums.correction_conjugate});
    // p = z + beta p with <p, A p_last> = 0; then alpha = <r, p> / <p, A p>, where <r, p_last> = 0 and <p, A p> follows
    // from the sums at hand.
    const double beta = report.iterations == 0 ? 0 : rounded(-zap / last_squares);
    const double squares = zaz + 2 * beta * zap + beta * beta * last_squares;
    const double alpha = rounded(zr / squares);
    norm = norm_of(operator_.advance(z, beta, alpha, direction_, phi, residual_, multigrid_.rhs()));
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
    const auto [sum, squares] = sum_over_ranks(operator_.moments(phi));
    operator_.subtract(rounded_mean(sum / volume_, std::sqrt(squares / volume_)), phi);
  }
  halo_.exchange<double>({&phi}, 1);
  report.true_residual =
      report.iterations == 0 ? norm : norm_of(operator_.residual(source, report.removed_mean, phi, nullptr));
  return report;
}

std::size_t MultigridSolver::n_bytes() const {
  return multigrid_.n_bytes() + residual_.n_bytes() + direction_.n_bytes();
}

Traffic MultigridSolver::traffic() const {
  Traffic sum = multigrid_.traffic();
  sum += halo_.traffic();
  sum += reductions_;
  return sum;
}

}  // namespace couplet::flow
