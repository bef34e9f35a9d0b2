#include "flow-server/poisson/pressure_solver.hpp"

#include "flow-server/poisson/multigrid_solver.hpp"

namespace couplet::flow {

std::unique_ptr<PressureSolver> make_pressure_solver(const PressureProblem& problem, PressureMethod) {
  return std::make_unique<MultigridSolver>(problem);
}

}  // namespace couplet::flow
