#pragma once
// What is fluid, where velocities are unknown, and which faces the pressure acts across.

#include "flow-server/boundary/flow_border.hpp"
#include "flow-server/immersed/fixed_solid.hpp"
#include "flow-server/momentum/flow_block.hpp"
#include "flow-server/navier_stokes/navier_stokes_setup.hpp"

namespace couplet::flow {

/// What bodies at rest keep from the flow for good; none where there are no bodies.
FixedSolid find_fixed_solid(const NavierStokesSetup& setup, const BlockDecomposition& decomposition);

/// Says of a cell by its middle whether the flow may reach it; empty where it reaches all. `solid` must outlive it.
FlowBorder::IsFluid fluid_of(const NavierStokesSetup& setup, const FixedSolid& solid);

/// Refers to grid and decomposition, which must outlive it.
FlowBlock make_flow_block(const NavierStokesSetup& setup, const BlockDecomposition& decomposition,
                          const FlowBorder& border, const FixedSolid& solid = {});

/// Whole borders where that says it all, face by face otherwise. Collective.
PressureProblem make_pressure_problem(const NavierStokesSetup& setup, const FlowBlock& block, const FlowBorder& border);

}  // namespace couplet::flow
