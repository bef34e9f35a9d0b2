#pragma once
// Whether bodies lie where the grid can see them.

#include <string>
#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/immersed/body_surfaces.hpp"

namespace couplet::flow {

/// Collective. A body without a prescribed motion must cut the grid: throws SceneError where it lies outside, between
/// the lines of the grid, or around all of it. Of one that moves, and may come in later, a sentence for the log tells
/// so.
std::vector<std::string> check_placement(BodySurfaces& bodies, const StretchedGrid& grid,
                                         const BlockDecomposition& decomposition);

}  // namespace couplet::flow
