#include "flow-server/navier_stokes/initial_flow.hpp"

#include <cmath>

#include "flow-server/momentum/body_force.hpp"
#include "flow-server/momentum/explicit_momentum.hpp"
#include "flow-server/navier_stokes/step_limit.hpp"

namespace couplet::flow {

namespace {

void set_velocity(const NavierStokesSetup& setup, const FlowBlock& block, VectorField& velocity) {
  for (int d = 0; d < block.n_dimensions; ++d) {
    const Box box = block.computed_faces(d);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const Triple cell{i, j, k};
          Triple inside = cell;  // of the grid, where the face stands on its border
          if (cell[d] == -1) inside[d] = 0;
          const bool is_on_border =
              cell[d] == -1 || (cell[d] == block.sizes[d] - 1 && block.decomposition->is_at_border(d, 1));
          const bool is_beside_fluid = is_on_border && block.cells.contains(inside[0], inside[1], inside[2]);
          if (is_beside_fluid || block.faces[d].contains(i, j, k))
            velocity[d](i, j, k) = setup.initial_velocity[d].at(centre_of_face(block, d, cell), 0);
        }
  }
}

bool is_given(const SpaceTimeValue& pressure) {
  return pressure.varies_in_space() || pressure.varies_in_time() || pressure.at({}, 0) != 0;
}

void set_pressure(const NavierStokesSetup& setup, const FlowBlock& block, Field<double>& pressure) {
  for (int k = 0; k < block.sizes[2]; ++k)
    for (int j = 0; j < block.sizes[1]; ++j)
      for_each_interval(block.cells, j, k, 0, block.sizes[0], [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
          pressure(i, j, k) = setup.initial_pressure.at(centre_of_cell(block, {i, j, k}), 0);
      });
}

/// All parts of a cut cell alike; the first projection tells them apart.
void set_piece_pressure(const NavierStokesSetup& setup, const FlowBlock& block, BodyGeometry& bodies) {
  const CutCells& cut = bodies.cut();
  for (std::size_t f = 0; f < bodies.piece_pressure.size(); ++f) {
    const CellPart& part = cut.parts()[static_cast<std::size_t>(cut.further_parts()[f])];
    const Triple& cell = cut.cells()[static_cast<std::size_t>(part.cell)].cell;
    bodies.piece_pressure[f] = setup.initial_pressure.at(centre_of_cell(block, cell), 0);
  }
}

/// du/dt by everything but the pressure, on all faces; on borders with a known velocity that of the border.
VectorField acceleration_without_pressure(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border,
                                          const FlowState& state) {
  VectorField acceleration = block.new_vector_field(), unused = block.new_vector_field();
  const double nu = setup.kinematic_viscosity();
  const MomentumWeights weights{.now = 1, .before = 0, .pressure = 0, .impulse = {}, .viscosity = nu};
  advance_momentum(block, block.everything(), weights, state.velocity, state.velocity, state.pressure, nullptr,
                   &acceleration, unused);
  BodyForce(block, setup.body_force, setup.density).add_all(0, 1, acceleration);
  border.add_pressure_change(1 / setup.density, state.pressure, acceleration);
  // Known velocities of the border: their change over a time that is short for the flow.
  const double step = longest_step(TimeScheme::runge_kutta, {state.courant_rate, diffusion_rate(setup.grid, nu)}, {});
  border.impose_rate(0, std::isfinite(step) ? 1e-3 * step : 1e-6, state.velocity, acceleration);
  return acceleration;
}

}  // namespace

void set_initial_flow(const NavierStokesSetup& setup, const FlowBlock& block, FlowBorder& border, FlowGhosts& ghosts,
                      PressureCorrection& correction, FlowState& state) {
  set_velocity(setup, block, state.velocity);
  border.set_pressure_time(0);
  border.begin_step(state.velocity);
  border.set_time(0, 0, state.velocity);
  border.impose(state.velocity);
  correction.place_bodies(0, state);
  correction.make_solenoidal(state);

  set_zero(block, state.pressure);
  if (is_given(setup.initial_pressure)) {
    set_pressure(setup, block, state.pressure);
    if (state.bodies) set_piece_pressure(setup, block, *state.bodies);
  } else if (!setup.bodies) {
    ghosts.fill(state.velocity);
    VectorField acceleration = acceleration_without_pressure(setup, block, border, state);
    correction.find_pressure(acceleration, state.pressure);
  }
  ghosts.fill(state);
}

}  // namespace couplet::flow
