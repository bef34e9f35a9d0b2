#pragma once
// The door to every solver of the pressure equation.

#include <array>
#include <memory>
#include <optional>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

/// Open share of each face, 0 to 1, entry i of the field of a direction being the face between the cells i and i + 1 of
/// it; entry -1 is the first face of the block. One ghost layer, filled.
using FaceFractions = std::array<Field<float>, 3>;

/// div grad phi = source, discretised with the cell volumes, face areas and centre distances of the grid. On a closed
/// face the normal derivative is 0; on an open face of a border of the grid phi = 0, half a cell away from the next
/// centre.
struct PressureProblem {
  const StretchedGrid* grid = nullptr;
  const BlockDecomposition* decomposition = nullptr;
  std::array<std::array<bool, 2>, 3> border_is_open{};  // whole borders; side 0: start, 1: end
  /// Where given, these count in place of border_is_open; cells without an open face are left out.
  std::optional<FaceFractions> open_share;
};

struct SolveLimits {
  double relative = 1e-6;  // of the residual norm that the start has with phi = 0
  double absolute = 0;     // residual norm [unit of the source]; whichever is reached first ends the solve
  int largest_iterations = 100;
};

struct SolveReport {
  int iterations = 0;
  int cycles = 0;            // of the multigrid; 0 for a direct solve
  double source_norm = 0;    // root of the volume-weighted mean of squares
  double true_residual = 0;  // same norm of source - div grad phi, computed in double from the solution itself
  double removed_mean = 0;   // of the source, in a problem without any open border
};

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;
  /// Collective. `phi` holds the start on entry (its ghosts need not be filled) and the solution, with one filled ghost
  /// layer at neighbours, on return. In a problem without any open border the mean of the source is taken out and phi
  /// has mean 0. Throws NumericsError when the residual is not a number or does not fall.
  virtual SolveReport solve(const Field<double>& source, Field<double>& phi, const SolveLimits& limits) = 0;
  virtual std::size_t n_bytes() const = 0;  // memory held on this rank
  virtual Traffic traffic() const = 0;      // sent so far by this rank
};

enum class PressureMethod { automatic, multigrid, fast_diagonalisation };

/// `automatic` takes fast diagonalisation where it can be used and is expected to be faster. Throws SceneError when the
/// method cannot solve the problem.
std::unique_ptr<PressureSolver> make_pressure_solver(const PressureProblem& problem, PressureMethod method);

}  // namespace couplet::flow
