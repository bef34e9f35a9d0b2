#include "flow-server/poisson/pressure_solver.hpp"

#include "flow-server/poisson/fast_diagonalisation.hpp"
#include "flow-server/poisson/multigrid_solver.hpp"

namespace couplet::flow {

std::unique_ptr<PressureSolver> make_pressure_solver(const PressureProblem& problem, PressureMethod method) {
  const bool is_direct = method == PressureMethod::fast_diagonalisation ||
                         (method == PressureMethod::automatic && prefers_fast_diagonalisation(problem));
  if (is_direct) return std::make_unique<FastDiagonalisation>(problem);
  return std::make_unique<MultigridSolver>(problem);
}

}  // namespace couplet::flow
