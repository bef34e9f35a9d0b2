#pragma once
// The accepted state of the flow as a file, written and read by all ranks together.

#include <filesystem>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/flow_state.hpp"
#include "flow-server/grid/stretched_grid.hpp"

namespace couplet::flow {

/// Collective. In full precision, cells in the order of the whole grid: any number of ranks can read it. Throws
/// FileError.
void write_navier_stokes_checkpoint(const std::filesystem::path& path, const FlowState& state,
                                    const StretchedGrid& grid, const BlockDecomposition& decomposition);

/// Collective. `state` has the shape of a state of this grid; ghosts are left as they are. Throws FileError when the
/// file belongs to another grid or is none.
void read_navier_stokes_checkpoint(const std::filesystem::path& path, const StretchedGrid& grid,
                                   const BlockDecomposition& decomposition, FlowState& state);

}  // namespace couplet::flow
