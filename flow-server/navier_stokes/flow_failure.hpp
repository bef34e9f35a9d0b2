#pragma once
// How the flow says where it has gone wrong: all ranks throw alike.

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

/// Collective. Throws NumericsError, naming the first cell, where a velocity is not a number.
void require_finite(const FlowBlock& block, const VectorField& velocity, double time);

/// Collective. Throws NumericsError: a step would have to be shorter than the smallest allowed [s], because of
/// diffusion or of the speed in a cell, which is named.
[[noreturn]] void refuse_step(const FlowBlock& block, const FlowState& state, bool is_by_diffusion, double step,
                              double smallest);

/// Throws NumericsError: a body moves through an open border, the one that it has come nearest to.
[[noreturn]] void refuse_leaving_body(const StretchedGrid& grid, const BodySurface& body, double time);

}  // namespace couplet::flow
