#pragma once
// Conjugate gradients in double precision around the multigrid in single precision.

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/poisson/multigrid.hpp"
#include "flow-server/poisson/pressure_operator.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// Flexible conjugate gradients (Polak-Ribiere): Y. Notay, "Flexible conjugate gradients", SIAM J. Sci. Comput. 22
/// (2000). Two reductions an iteration.
class MultigridSolver : public PressureSolver {
 public:
  explicit MultigridSolver(const PressureProblem& problem);

  SolveReport solve(const Field<double>& source, Field<double>& phi, const SolveLimits& limits) override;
  std::size_t n_bytes() const override;
  Traffic traffic() const override;

 private:
  template <std::size_t n>
  std::array<double, n> sum_over_ranks(std::array<double, n> sums);

  const BlockDecomposition* decomposition_;
  PressureOperator operator_;
  Multigrid multigrid_;
  HaloExchange halo_;
  Field<double> residual_;
  Field<float> direction_;
  bool is_singular_ = false;
  double volume_ = 0;  // of all active cells [m^3]
  Traffic reductions_;
};

}  // namespace couplet::flow
