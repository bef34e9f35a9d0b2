// Flows that break solvers.

#include <gtest/gtest.h>

#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {
namespace {

const double pi = std::numbers::pi;
const std::vector<double> one_cell = uniform_faces(0, 1, 1);

/// Steps on and returns the largest speed met.
double march(FractionalStep& flow, FlowState& state, double step, int n_steps, double* energy_growth = nullptr) {
  FlowState next;
  double speed = 0, energy = kinetic_energy(flow, state);
  for (int n = 0; n < n_steps; ++n) {
    speed = std::max(speed, flow.advance(state, step, next).largest_speed);
    std::swap(state, next);
    const double now = kinetic_energy(flow, state);
    if (energy_growth) *energy_growth = std::max(*energy_growth, now / energy - 1);
    energy = now;
  }
  return speed;
}

/// Walls all around, the lid at y = 1 moves with 1 m/s.
NavierStokesSetup cavity(const std::vector<double>& x, const std::vector<double>& y, TimeScheme scheme) {
  NavierStokesSetup setup = setup_on(box_grid({x, y, one_cell}, {false, false, false}, 2), scheme);
  PrescribedVelocity lid;
  lid.velocity[0] = 1.0;
  setup.border[1][1] = {FacePatch{.name = "lid", .condition = lid}};
  setup.pressure = {};  // as a user would run it
  return setup;
}

class HardFlow : public testing::TestWithParam<TimeScheme> {};

TEST_P(HardFlow, AtReynoldsNumber100000OnACoarseGridStaysBounded) {
  NavierStokesSetup setup = cavity(uniform_faces(0, 1, 16), uniform_faces(0, 1, 16), GetParam());
  setup.viscosity = 1e-5;
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state();
  EXPECT_LE(march(flow, state, 0.1, 300), 1.5);  // central differences overshoot the lid's speed beside it
}

TEST_P(HardFlow, OnCellsOfAspectRatio50AndStretched20ToOneStaysBounded) {
  NavierStokesSetup setup =
      cavity(uniform_faces(0, 5, 16), symmetrically_stretched_faces(0, 1, 40, 1.0 / 20), GetParam());
  setup.viscosity = 1e-3;
  EXPECT_GT(setup.grid.axis[0].width(0), 50 * setup.grid.axis[1].width(0));
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state();
  EXPECT_LE(march(flow, state, 0.2, 50), 3);  // Crank-Nicolson rings after a lid that starts at once
  EXPECT_LE(march(flow, state, 0.2, 50), 1.5);
}

TEST_P(HardFlow, AtTheLargestCourantNumberForManySteps) {
  // Whatever the duration, the steps inside are the longest the scheme allows itself.
  NavierStokesSetup setup = setup_on(
      box_grid({uniform_faces(0, 1, 8), uniform_faces(0, 1, 8), one_cell}, {true, true, false}, 2), GetParam());
  for (int c = 0; c < 2; ++c)
    setup.initial_velocity[c] = SpaceTimeValue([c](const Point& p, double) {
      return 0.5 + std::sin(2 * pi * p[1 - c] + c) + 0.3 * std::sin(6 * pi * p[1 - c]);
    });
  setup.viscosity = 1e-5;
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState start = flow.initial_state(), end;
  const double energy = kinetic_energy(flow, start);
  const AdvanceReport report = flow.advance(start, 1500, end);
  EXPECT_GE(report.n_steps, 10000);
  EXPECT_LT(kinetic_energy(flow, end), energy);
  EXPECT_GT(kinetic_energy(flow, end), 0.2 * energy);  // the mean flow stays
}

TEST_P(HardFlow, WithStepsThatJumpByTenToAndFroStaysBounded) {
  NavierStokesSetup setup = cavity(uniform_faces(0, 1, 16), uniform_faces(0, 1, 16), GetParam());
  setup.viscosity = 1e-3;
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state();
  for (int n = 0; n < 40; ++n) EXPECT_LE(march(flow, state, n % 2 == 0 ? 0.02 : 0.002, 5), 1.5);
}

TEST_P(HardFlow, UnderGravityInAClosedBoxStaysAtRest) {
  NavierStokesSetup setup = cavity(uniform_faces(0, 1, 16), symmetrically_stretched_faces(0, 1, 16, 3), GetParam());
  setup.border = {};
  setup.density = 1000, setup.viscosity = 1e-3;
  setup.body_force[1] = -9810.0;
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state();
  EXPECT_LE(march(flow, state, 0.01, 20), 1e-8);  // the first pressure is found to 1e-10 of g
  EXPECT_LE(error_of(
                flow, state.pressure, -1, [](const Point& p) { return 9810 * (0.5 - p[1]); }, true)
                .largest,
            1e-5 * 9810);
}

TEST_P(HardFlow, DrivenByAPressureThatReversesWithinTwoStepsFollowsIt) {
  const double step = 0.01, length = 2, viscosity = 0.02;
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, length, 16), uniform_faces(0, 1, 16), one_cell}, {false, false, false}, 2),
               GetParam());
  setup.viscosity = viscosity;
  // 20 m^2/s^2 for 0.5 s, then -20: a plug of 5 m/s that is stopped and driven back.
  const scene::TimeTable drive{.time = {0, 0.5, 0.5 + 2 * step, 1.5}, .value = {20, 20, -20, -20}};
  setup.border[0][0] = {FacePatch{.name = "in", .condition = PressureOpening{drive}}};
  setup.border[0][1] = {FacePatch{.name = "out", .condition = PressureOpening{0.0}}};
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state();
  const auto flow_rate = [&] {
    double sum = 0;
    const Triple sizes = blocks.mine().sizes();
    for (int j = 0; j < sizes[1]; ++j)
      for (int i = 0; i < sizes[0]; ++i)
        sum += state.velocity[0](i, j, 0) * setup.grid.axis[1].width(blocks.mine().begin[1] + j);
    return summed(sum) / 16;
  };
  march(flow, state, step, 50);
  const double forward = flow_rate();
  EXPECT_GT(forward, 3);
  EXPECT_LT(forward, 5);  // dp/(rho L) t less what the walls take
  const double speed = march(flow, state, step, 100);
  EXPECT_LT(speed, 10);
  EXPECT_LT(flow_rate(), -1);
}

/// A vortex that the stream carries through the end of the domain.
double energy_after_vortex_has_left(const FaceCondition& exit, double swirl, TimeScheme scheme, double& largest_speed,
                                    double& backflow) {
  NavierStokesSetup setup = setup_on(
      box_grid({uniform_faces(0, 4, 64), uniform_faces(-1, 1, 32), one_cell}, {false, false, false}, 2), scheme);
  setup.viscosity = 1e-3;
  PrescribedVelocity stream;
  stream.velocity[0] = 1.0;
  setup.border[0][0] = {FacePatch{.name = "inlet", .condition = stream}};
  setup.border[0][1] = {FacePatch{.name = "exit", .condition = exit}};
  for (int side = 0; side < 2; ++side) setup.border[1][side] = {FacePatch{.name = "side", .condition = SlipWall{}}};
  const auto vortex = [swirl](const Point& p) {
    const double x = p[0] - 2.5, y = p[1];
    return swirl / 0.3 * std::exp(0.5 - 0.5 * (x * x + y * y) / 0.09);
  };
  setup.initial_velocity[0] = SpaceTimeValue([vortex](const Point& p, double) { return 1 - p[1] * vortex(p); });
  setup.initial_velocity[1] = SpaceTimeValue([vortex](const Point& p, double) { return (p[0] - 2.5) * vortex(p); });
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  largest_speed = backflow = 0;
  for (int n = 0; n < 100; ++n) {
    largest_speed = std::max(largest_speed, flow.advance(state, 0.05, next).largest_speed);
    std::swap(state, next);
    if (blocks.is_at_border(0, 1))
      for (int j = 0; j < blocks.mine().size(1); ++j)
        backflow = std::min(backflow, state.velocity[0](blocks.mine().size(0) - 1, j, 0));
  }
  MPI_Allreduce(MPI_IN_PLACE, &backflow, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
  // What is left beside the stream.
  return std::pow(error_of(flow, state.velocity[0], 0, [](const Point&) { return 1.0; }).rms, 2) +
         std::pow(error_of(flow, state.velocity[1], 1, [](const Point&) { return 0.0; }).rms, 2);
}

TEST_P(HardFlow, SwallowsAVortexThroughAConvectiveOutflow) {
  double speed = 0, backflow = 0;
  const double left = energy_after_vortex_has_left(ConvectiveOutflow{}, 0.8, GetParam(), speed, backflow);
  EXPECT_LT(speed, 2);
  EXPECT_LT(left, 1e-3);  // of 0.06 in the beginning
}

TEST_P(HardFlow, SurvivesBackflowThroughItsExits) {
  for (const FaceCondition& exit : {FaceCondition(ConvectiveOutflow{}), FaceCondition(PressureOpening{0.0})}) {
    double speed = 0, backflow = 0;
    const double left = energy_after_vortex_has_left(exit, 2.5, GetParam(), speed, backflow);
    EXPECT_LT(backflow, -0.2);
    EXPECT_LT(speed, 5);    // of 3.5 in the beginning
    EXPECT_LT(left, 0.06);  // of 0.6 in the beginning
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, HardFlow,
                         testing::Values(TimeScheme::automatic, TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                         TimeScheme::crank_nicolson));

}  // namespace
}  // namespace couplet::flow
