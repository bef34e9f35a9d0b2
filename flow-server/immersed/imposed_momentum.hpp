#pragma once
// The reaction to the momentum that walls impose on the fluid beside them.

#include <vector>

#include "flow-server/immersed/body_loads.hpp"

namespace couplet::flow {

/// Adds to the pressure force on corners, of the velocities on this rank alone.
///
/// Near a wall velocities are imposed once a step, and what is imposed is free of divergence up to an error of space
/// only. The projection takes that error m back, with a pressure of the order rho m / dt in the cells at the wall: the
/// fluid beyond them feels nothing of it, as a force of the walls' on the fluid stands against it. The force of the
/// pressure alone therefore grows like 1 / dt - on a cylinder of 12.5 cells a diameter by 13 % at a Courant number of
/// 0.016 - and with the reaction to what was imposed does not. It is, for each velocity of the volume V that it stands
/// for in the pressure problem (area of its piece of the face times the distance of the cells' middles),
///     hybrid:          F = -rho V share (u_wall value - u) / dt,
/// u_wall value being what the wall would impose on the flow at the end of the step. For pieces that take the
/// velocity of a ghost the same is found from the slopes g of the pressure across the piece and at the image, as the
/// projection has left (dt / rho) (g_piece - g_image) of slip there:
///     piece of ghosts: F = -V (g_piece - g_image).
/// Where a smooth free edge is open by o, the share 1 - o of a piece's volume is the ghost's and o that of the
/// velocity at the face's middle. The force acts at the nearest point of the wall.
void add_imposed_momentum(const FlowBlock& block, double density, const FlowState& state,
                          std::vector<SurfaceLoad>& loads);

}  // namespace couplet::flow
