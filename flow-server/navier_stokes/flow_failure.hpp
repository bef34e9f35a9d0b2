#pragma once
// How the flow says where it has gone wrong: all ranks throw alike.

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

/// Collective. Throws NumericsError, naming the first cell, where a velocity is not a number.
void require_finite(const FlowBlock& block, const VectorField& velocity, double time);

/// Collective. Throws NumericsError: a step would have to be shorter than the smallest allowed [s], because of
/// diffusion or of the speed in a cell, which is named.
[[noreturn]] void refuse_step(const FlowBlock& block, const FlowState& state, bool is_by_diffusion, double step,
                              double smallest);

}  // namespace couplet::flow
