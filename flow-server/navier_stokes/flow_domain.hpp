#pragma once
// What is fluid, where velocities are unknown, and which faces the pressure acts across.

#include "flow-server/boundary/flow_border.hpp"
#include "flow-server/momentum/flow_block.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"

namespace couplet::flow {

/// Both refer to grid and decomposition, which must outlive them.
FlowBlock make_flow_block(const NavierStokesSetup& setup, const BlockDecomposition& decomposition,
                          const FlowBorder& border);

/// Whole borders where that says it all, face by face otherwise. Collective.
PressureProblem make_pressure_problem(const NavierStokesSetup& setup, const FlowBlock& block, const FlowBorder& border);

}  // namespace couplet::flow
