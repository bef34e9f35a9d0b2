#include "tests/benchmarks/hypre_poisson.hpp"

#include <HYPRE.h>
#include <HYPRE_struct_ls.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace couplet::flow {

HypreReport solve_with_hypre(const StretchedGrid& grid, const BlockDecomposition& blocks, const Field<double>& source,
                             double tolerance, int n_repeats, Field<double>& phi) {
  const MPI_Comm communicator = blocks.communicator();
  const Box mine = blocks.mine();
  HYPRE_Int first[3], last[3];
  for (int d = 0; d < 3; ++d) first[d] = mine.begin[d], last[d] = mine.end[d] - 1;
  HYPRE_Init();
  HYPRE_StructGrid cells;
  HYPRE_StructGridCreate(communicator, 3, &cells);
  HYPRE_StructGridSetExtents(cells, first, last);
  HYPRE_StructGridAssemble(cells);
  HYPRE_StructStencil stencil;
  HYPRE_StructStencilCreate(3, 4, &stencil);
  HYPRE_Int offsets[4][3] = {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  for (int entry = 0; entry < 4; ++entry) HYPRE_StructStencilSetElement(stencil, entry, offsets[entry]);

  // - volume * (div grad): symmetric and positive; only the lower neighbours are stored.
  const auto n = static_cast<std::size_t>(mine.n_cells());
  std::vector<double> entries, right_hand_side;
  entries.reserve(4 * n), right_hand_side.reserve(n);
  for (int k = mine.begin[2]; k < mine.end[2]; ++k)
    for (int j = mine.begin[1]; j < mine.end[1]; ++j)
      for (int i = mine.begin[0]; i < mine.end[0]; ++i) {
        const Triple cell{i, j, k};
        const double volume = grid.volume(cell);
        double diagonal = 0, lower[3];
        for (int d = 0; d < 3; ++d) {
          const StretchedAxis& axis = grid.axis[d];
          const double area = volume / axis.width(cell[d]);
          lower[d] = cell[d] > 0 ? area / axis.distance(cell[d] - 1) : 0;
          diagonal += lower[d] + (cell[d] + 1 < axis.n_cells() ? area / axis.distance(cell[d]) : 0);
        }
        entries.insert(entries.end(), {diagonal, -lower[0], -lower[1], -lower[2]});
        right_hand_side.push_back(-volume * source(i - mine.begin[0], j - mine.begin[1], k - mine.begin[2]));
      }
  HYPRE_StructMatrix matrix;
  HYPRE_StructMatrixCreate(communicator, cells, stencil, &matrix);
  HYPRE_StructMatrixSetSymmetric(matrix, 1);
  HYPRE_StructMatrixInitialize(matrix);
  HYPRE_Int numbers[4] = {0, 1, 2, 3};
  HYPRE_StructMatrixSetBoxValues(matrix, first, last, 4, numbers, entries.data());
  HYPRE_StructMatrixAssemble(matrix);
  HYPRE_StructVector b, x;
  for (HYPRE_StructVector* vector : {&b, &x}) {
    HYPRE_StructVectorCreate(communicator, cells, vector);
    HYPRE_StructVectorInitialize(*vector);
  }
  HYPRE_StructVectorSetBoxValues(b, first, last, right_hand_side.data());
  HYPRE_StructVectorAssemble(b);
  HYPRE_StructVectorSetConstantValues(x, 0.0);
  HYPRE_StructVectorAssemble(x);

  HypreReport report;
  MPI_Barrier(communicator);
  double start = MPI_Wtime();
  HYPRE_StructSolver preconditioner, solver;
  HYPRE_StructPFMGCreate(communicator, &preconditioner);
  HYPRE_StructPFMGSetMaxIter(preconditioner, 1);
  HYPRE_StructPFMGSetTol(preconditioner, 0.0);
  HYPRE_StructPFMGSetZeroGuess(preconditioner);
  // The coarsest level must not become one cell: the problem is singular.
  int n_levels = -2;
  for (int d = 0; d < 3; ++d) n_levels += static_cast<int>(std::ceil(std::log2(grid.axis[d].n_cells())));
  HYPRE_StructPFMGSetMaxLevels(preconditioner, n_levels);
  HYPRE_StructPFMGSetRAPType(preconditioner, 1);    // 7-point coarse operators: the fastest here
  HYPRE_StructPFMGSetRelaxType(preconditioner, 2);  // red-black Gauss-Seidel
  HYPRE_StructPFMGSetSkipRelax(preconditioner, 1);
  HYPRE_StructPFMGSetNumPreRelax(preconditioner, 1);
  HYPRE_StructPFMGSetNumPostRelax(preconditioner, 1);
  HYPRE_StructPCGCreate(communicator, &solver);
  HYPRE_StructPCGSetMaxIter(solver, 200);
  HYPRE_StructPCGSetTol(solver, tolerance);
  HYPRE_StructPCGSetTwoNorm(solver, 1);
  HYPRE_StructPCGSetPrecond(solver, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, preconditioner);
  HYPRE_StructPCGSetup(solver, matrix, b, x);
  MPI_Barrier(communicator);
  report.set_up_seconds = MPI_Wtime() - start;
  report.seconds = 1e30;
  for (int repeat = 0; repeat < n_repeats; ++repeat) {
    HYPRE_StructVectorSetConstantValues(x, 0.0);
    MPI_Barrier(communicator);
    start = MPI_Wtime();
    HYPRE_StructPCGSolve(solver, matrix, b, x);
    MPI_Barrier(communicator);
    report.seconds = std::min(report.seconds, MPI_Wtime() - start);
  }
  HYPRE_Int n_iterations = 0;
  HYPRE_StructPCGGetNumIterations(solver, &n_iterations);
  report.iterations = static_cast<int>(n_iterations);
  std::vector<double> values(n);
  HYPRE_StructVectorGetBoxValues(x, first, last, values.data());
  std::size_t at = 0;
  for (int k = 0; k < mine.size(2); ++k)
    for (int j = 0; j < mine.size(1); ++j)
      for (int i = 0; i < mine.size(0); ++i) phi(i, j, k) = values[at++];

  HYPRE_StructPCGDestroy(solver);
  HYPRE_StructPFMGDestroy(preconditioner);
  HYPRE_StructVectorDestroy(b);
  HYPRE_StructVectorDestroy(x);
  HYPRE_StructMatrixDestroy(matrix);
  HYPRE_StructStencilDestroy(stencil);
  HYPRE_StructGridDestroy(cells);
  HYPRE_Finalize();
  return report;
}

}  // namespace couplet::flow
