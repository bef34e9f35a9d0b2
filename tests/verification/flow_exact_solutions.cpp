// Orders of convergence in space and time against exact solutions.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/oracle/ethier_steinman.hpp"
#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {
namespace {

using oracle::EthierSteinman;

using std::numbers::pi;

NavierStokesSetup ethier_steinman(const EthierSteinman& exact, int n_cells, double stretching, TimeScheme scheme) {
  const std::vector<double> faces = symmetrically_stretched_faces(-1, 1, n_cells, stretching);
  NavierStokesSetup setup = setup_on(box_grid({faces, faces, faces}, {false, false, false}), scheme);
  setup.viscosity = exact.viscosity;
  setup.balances_inflow = true;  // velocities at the middle of faces sum up to zero to second order only
  setup.initial_pressure = SpaceTimeValue([exact](const Point& x, double) { return exact.pressure(x, 0); });
  PrescribedVelocity border;
  for (int c = 0; c < 3; ++c) {
    border.velocity[c] = SpaceTimeValue([exact, c](const Point& x, double t) { return exact.velocity(c, x, t); });
    setup.initial_velocity[c] = border.velocity[c];
  }
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) setup.border[d][side] = {FacePatch{.name = "exact", .condition = border}};
  return setup;
}

struct Errors {
  Norms velocity, pressure;
};

Errors run(const EthierSteinman& exact, const NavierStokesSetup& setup, double end, int n_steps) {
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  for (int n = 0; n < n_steps; ++n) {
    flow.advance(state, end / n_steps, next);
    std::swap(state, next);
  }
  Errors errors;
  for (int c = 0; c < 3; ++c) {
    const Norms e = error_of(flow, state.velocity[c], c, [&](const Point& x) { return exact.velocity(c, x, end); });
    errors.velocity.rms = std::max(errors.velocity.rms, e.rms);
    errors.velocity.largest = std::max(errors.velocity.largest, e.largest);
  }
  errors.pressure = error_of(
      flow, state.pressure, -1, [&](const Point& x) { return exact.pressure(x, state.pressure_time); }, true);
  return errors;
}

class FlowOrder : public testing::TestWithParam<std::tuple<TimeScheme, double>> {};

TEST_P(FlowOrder, InSpace) {
  const auto [scheme, stretching] = GetParam();
  const EthierSteinman exact{0.1};
  std::vector<Errors> errors;
  for (const int n : {32, 64}) errors.push_back(run(exact, ethier_steinman(exact, n, stretching, scheme), 0.05, n / 8));
  EXPECT_GE(order_between(errors[0].velocity.rms, errors[1].velocity.rms), 1.9);
  EXPECT_GE(order_between(errors[0].velocity.largest, errors[1].velocity.largest), 1.9);
  EXPECT_GE(order_between(errors[0].pressure.rms, errors[1].pressure.rms), 1.9);
  EXPECT_GE(order_between(errors[0].pressure.largest, errors[1].pressure.largest), 1.9);
}

INSTANTIATE_TEST_SUITE_P(Schemes, FlowOrder,
                         testing::Combine(testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                                          TimeScheme::crank_nicolson),
                                          testing::Values(1.0, 3.0)));

}  // namespace
}  // namespace couplet::flow
