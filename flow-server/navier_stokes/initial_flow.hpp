#pragma once
// The flow at t = 0.

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/navier_stokes/flow_ghosts.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"
#include "flow-server/navier_stokes/pressure_correction.hpp"

namespace couplet::flow {

/// Collective. The given velocity without its divergence; the given pressure or, where it is 0, that which keeps the
/// flow free of divergence, so that the first step is as exact as all others. `state` has its fields; ghosts are
/// filled.
void set_initial_flow(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border, FlowGhosts& ghosts,
                      PressureCorrection& correction, FlowState& state);

}  // namespace couplet::flow
