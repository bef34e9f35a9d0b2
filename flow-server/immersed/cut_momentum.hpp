#pragma once
// Convection and diffusion of velocities whose neighbours are partly behind a wall.

#include "flow-server/immersed/wall_layer.hpp"
#include "flow-server/momentum/explicit_momentum.hpp"

namespace couplet::flow {

/// What advance_momentum() computed for cut rows took neighbours behind walls for fluid: replaces its rate by that with
/// ghosts in their place, or by `share` of the way to it. `velocity`: that was advanced, ghosts filled; `now`: weight
/// of the rate in new_velocity [s]; `rate`: corrected too where given.
void correct_cut_rows(const FlowBlock& block, const WallLayer& layer, double share, double viscosity, double now,
                      const VectorField& velocity, VectorField* rate, VectorField& new_velocity);

}  // namespace couplet::flow
