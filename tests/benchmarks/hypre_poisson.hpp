#pragma once
// The peer of bench poisson: hypre's structured-grid multigrid. Built only where hypre is installed.

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/stretched_grid.hpp"

namespace couplet::flow {

struct HypreReport {
  int iterations = 0;
  double set_up_seconds = 0, seconds = 0;  // the fastest of the repeats
};

/// Conjugate gradients preconditioned by PFMG (R. D. Falgout, J. E. Jones, "Multigrid on massively parallel
/// architectures", 2000) for the same cells, areas and distances, all borders closed. `phi` starts from 0.
HypreReport solve_with_hypre(const StretchedGrid& grid, const BlockDecomposition& blocks, const Field<double>& source,
                             double tolerance, int n_repeats, Field<double>& phi);

}  // namespace couplet::flow
