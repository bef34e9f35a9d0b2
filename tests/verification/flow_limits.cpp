// Exact limits: kinetic energy without viscosity, parallel flows, momentum, order in time.

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "tests/oracle/ethier_steinman.hpp"
#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;

FlowState march(FractionalStep& flow, double end, int n_steps) {
  FlowState state = flow.initial_state(), next;
  for (int n = 0; n < n_steps; ++n) {
    flow.advance(state, end / n_steps, next);
    std::swap(state, next);
  }
  return state;
}

/// Three-dimensional Taylor-Green vortex in a periodic box that is stretched in x and y.
NavierStokesSetup taylor_green(int n_cells, double stretching, TimeScheme scheme) {
  const auto x = symmetrically_stretched_faces(-pi, pi, n_cells, stretching);
  const auto y = symmetrically_stretched_faces(-pi, pi, n_cells, 1 + 0.5 * (stretching - 1));
  NavierStokesSetup setup = setup_on(box_grid({x, y, uniform_faces(-pi, pi, n_cells)}, {true, true, true}), scheme);
  setup.initial_velocity[0] =
      SpaceTimeValue([](const Point& p, double) { return std::sin(p[0]) * std::cos(p[1]) * std::cos(p[2]); });
  setup.initial_velocity[1] =
      SpaceTimeValue([](const Point& p, double) { return -std::cos(p[0]) * std::sin(p[1]) * std::cos(p[2]); });
  setup.pressure.relative_tolerance = 1e-11;
  setup.pressure.divergence_tolerance = 1e-14;
  setup.step.courant = 5;  // the steps are those asked for
  return setup;
}

double energy_drift(double stretching, TimeScheme scheme, int n_steps) {
  const NavierStokesSetup setup = taylor_green(16, stretching, scheme);
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  const double before = kinetic_energy(flow, flow.initial_state());
  return kinetic_energy(flow, march(flow, 2, n_steps)) / before - 1;
}

class FlowEnergy : public testing::TestWithParam<double> {};

TEST_P(FlowEnergy, OfAnInviscidFlowDriftsWithTheOrderOfTheTimeSchemeOnly) {
  // Space contributes nothing: whatever is left falls with the step. The stages of Runge-Kutta have the divergence of a
  // pressure that is half a step old: second order; what Adams-Bashforth gains is of higher order.
  for (const TimeScheme scheme : {TimeScheme::runge_kutta, TimeScheme::adams_bashforth}) {
    const double coarse = energy_drift(GetParam(), scheme, 40), fine = energy_drift(GetParam(), scheme, 80);
    EXPECT_GE(order_between(std::abs(coarse), std::abs(fine)), 1.9);
    EXPECT_LE(std::abs(fine), 1e-5);  // measured: 5.5e-6
  }
}
INSTANTIATE_TEST_SUITE_P(Stretched, FlowEnergy, testing::Values(1.0, 3.0));

TEST(FlowLimit, KeepsMomentumInAPeriodicBox) {
  NavierStokesSetup setup = taylor_green(16, 3, TimeScheme::runge_kutta);
  setup.viscosity = 0.01;
  setup.initial_velocity[2] = 0.7;
  setup.body_force[2] = 0.5;
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  const double end = 0.4;
  const FlowState state = march(flow, end, 8);
  const Box mine = blocks.mine();
  std::array<double, 3> momentum{};
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < mine.size(2); ++k)
      for (int j = 0; j < mine.size(1); ++j)
        for (int i = 0; i < mine.size(0); ++i) {
          const Triple cell{i, j, k};
          double volume = 1;
          for (int d = 0; d < 3; ++d) {
            const int global = mine.begin[d] + cell[d];
            volume *= d == c ? setup.grid.axis[d].distance(global) : setup.grid.axis[d].width(global);
          }
          momentum[c] += volume * state.velocity[c](i, j, k);
        }
  const double box = 8 * pi * pi * pi;
  const double scale = 1e-12 * box;  // round-off of sums over 4096 cells
  EXPECT_NEAR(summed(momentum[0]), 0, scale);
  EXPECT_NEAR(summed(momentum[1]), 0, scale);
  EXPECT_NEAR(summed(momentum[2]), box * (0.7 + 0.5 * end), scale);
}

/// A slit along x with walls across y, at rest or driven by a force.
NavierStokesSetup slit(const std::vector<double>& y, TimeScheme scheme, int n_x = 4) {
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 1, n_x), y, uniform_faces(0, 1, 1)}, {true, false, false}, 2), scheme);
  setup.viscosity = 0.1;
  return setup;
}

std::vector<double> linearly_growing_faces(int n_cells) {
  std::vector<double> faces{0};
  for (int j = 0; j < n_cells; ++j) faces.push_back(faces.back() + 1 + 0.1 * j);
  for (double& face : faces) face /= faces.back();
  faces.back() = 1;
  return faces;
}

class ParallelFlow : public testing::TestWithParam<TimeScheme> {};

TEST_P(ParallelFlow, OfPoiseuilleIsExactWhereWidthsChangeLinearly) {
  for (const auto& y : {uniform_faces(0, 1, 8), linearly_growing_faces(10)}) {
    NavierStokesSetup setup = slit(y, GetParam());
    const double force = 3;
    const auto exact = [&](const Point& p) { return 0.5 * force / setup.viscosity * p[1] * (1 - p[1]); };
    setup.body_force[0] = force;
    setup.initial_velocity[0] = SpaceTimeValue([&](const Point& p, double) { return exact(p); });
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    const FlowState state = march(flow, 0.2, 10);
    EXPECT_LE(error_of(flow, state.velocity[0], 0, exact).largest, 1e-13 * 4);  // round-off of a speed of 4
  }
}

TEST_P(ParallelFlow, BetweenOpeningsIsThatOfPoiseuilleFromRest) {
  NavierStokesSetup setup = slit(uniform_faces(0, 1, 8), GetParam());
  setup.grid =
      box_grid({uniform_faces(0, 2, 8), uniform_faces(0, 1, 8), uniform_faces(0, 1, 1)}, {false, false, false}, 2);
  const double drop = 2;  // over a length of 2
  setup.border[0][0] = {FacePatch{.name = "in", .condition = PressureOpening{drop}}};
  setup.border[0][1] = {FacePatch{.name = "out", .condition = PressureOpening{0.0}}};
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  const FlowState state = march(flow, 20, 400);  // exp(-pi^2 nu t) = 3e-9
  const auto exact = [&](const Point& p) { return 0.5 / setup.viscosity * p[1] * (1 - p[1]); };
  EXPECT_LE(error_of(flow, state.velocity[0], 0, exact).largest, 1e-7 * 1.25);
  EXPECT_LE(error_of(flow, state.pressure, -1, [&](const Point& p) { return drop - p[0]; }).largest, 1e-7 * drop);
}

TEST_P(ParallelFlow, BetweenStaircaseWallsIsSecondOrder) {
  // The slit is part of the grid; its walls lie along cell faces at y = 0 and 1.
  std::vector<double> errors;
  for (const int n : {12, 24}) {
    NavierStokesSetup setup = slit(uniform_faces(-0.25, 1.25, n), GetParam());
    setup.is_fluid = [](const Point& p) { return p[1] > 0 && p[1] < 1; };
    setup.body_force[0] = 3;
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    const FlowState state = march(flow, 20, 100);
    const auto exact = [&](const Point& p) {
      return p[1] > 0 && p[1] < 1 ? 0.5 * 3 / setup.viscosity * p[1] * (1 - p[1]) : 0.0;
    };
    errors.push_back(error_of(flow, state.velocity[0], 0, exact).largest);
  }
  EXPECT_LE(errors[0], 0.06);  // the linear ghost shifts the parabola by G h^2 / (8 mu) = 0.059
  EXPECT_GE(order_between(errors[0], errors[1]), 1.9);
}

/// u = Re{ G/(i w) (1 - cosh(k (y - 1/2)) / cosh(k/2)) e^{i w t} }, k^2 = i w / nu: the flow in a slit under G cos(w
/// t).
double womersley(double y, double t, double viscosity, double frequency) {
  const std::complex<double> i(0, 1), k = std::sqrt(i * frequency / viscosity);
  return std::real((1.0 - std::cosh(k * (y - 0.5)) / std::cosh(0.5 * k)) / (i * frequency) *
                   std::exp(i * frequency * t));
}

TEST_P(ParallelFlow, OfWomersleyIsSecondOrder) {
  const double frequency = 4 * pi, viscosity = 0.1, end = 0.5;
  std::vector<double> errors;
  for (const int n : {16, 32}) {
    NavierStokesSetup setup = slit(symmetrically_stretched_faces(0, 1, n, 0.5), GetParam());
    setup.viscosity = viscosity;
    setup.body_force[0] = SpaceTimeValue([&](const Point&, double t) { return std::cos(frequency * t); });
    setup.initial_velocity[0] =
        SpaceTimeValue([&](const Point& p, double) { return womersley(p[1], 0, viscosity, frequency); });
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    const FlowState state = march(flow, end, 2 * n);
    errors.push_back(error_of(flow, state.velocity[0], 0, [&](const Point& p) {
                       return womersley(p[1], end, viscosity, frequency);
                     }).largest);
  }
  EXPECT_GE(order_between(errors[0], errors[1]), 1.9);
}

TEST_P(ParallelFlow, TwoDimensionalTaylorGreenIsSecondOrder) {
  std::vector<std::array<double, 2>> errors;
  const double viscosity = 0.05, end = 0.5;
  for (const int n : {32, 64}) {
    const auto x = symmetrically_stretched_faces(-pi, pi, n, 2), y = uniform_faces(-pi, pi, n);
    NavierStokesSetup setup = setup_on(box_grid({x, y, uniform_faces(0, 1, 1)}, {true, true, false}, 2), GetParam());
    setup.viscosity = viscosity;
    setup.initial_velocity[0] = SpaceTimeValue([](const Point& p, double) { return std::sin(p[0]) * std::cos(p[1]); });
    setup.initial_velocity[1] = SpaceTimeValue([](const Point& p, double) { return -std::cos(p[0]) * std::sin(p[1]); });
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    const FlowState state = march(flow, end, n / 2);
    const double decay = std::exp(-2 * viscosity * end),
                 pressure_decay = std::exp(-4 * viscosity * state.pressure_time);
    errors.push_back(
        {error_of(flow, state.velocity[0], 0, [&](const Point& p) { return decay * std::sin(p[0]) * std::cos(p[1]); })
             .largest,
         error_of(
             flow, state.pressure, -1,
             [&](const Point& p) { return 0.25 * pressure_decay * (std::cos(2 * p[0]) + std::cos(2 * p[1])); }, true)
             .largest});
  }
  for (int q = 0; q < 2; ++q) EXPECT_GE(order_between(errors[0][q], errors[1][q]), 1.9);
}

INSTANTIATE_TEST_SUITE_P(Schemes, ParallelFlow,
                         testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                         TimeScheme::crank_nicolson));

class FlowOrderInTime : public testing::TestWithParam<TimeScheme> {};

TEST_P(FlowOrderInTime, IsTwoAlsoWhereTheStepJumps) {
  // On one grid, so that the error of space is the same in all.
  const oracle::EthierSteinman exact{0.05};
  const auto faces = symmetrically_stretched_faces(-1, 1, 12, 1.5);
  NavierStokesSetup setup = setup_on(box_grid({faces, faces, faces}, {false, false, false}), GetParam());
  setup.viscosity = exact.viscosity;
  setup.balances_inflow = true;
  setup.pressure.relative_tolerance = 1e-10;
  setup.step.courant = 5;
  PrescribedVelocity border;
  for (int c = 0; c < 3; ++c) {
    border.velocity[c] = SpaceTimeValue([exact, c](const Point& x, double t) { return exact.velocity(c, x, t); });
    setup.initial_velocity[c] = border.velocity[c];
  }
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) setup.border[d][side] = {FacePatch{.name = "exact", .condition = border}};
  const BlockDecomposition blocks = decompose(setup.grid);
  const double end = 0.6;
  // Steps of one length in the first third, ten times shorter ones in the second, long ones again in the last.
  const auto run = [&](TimeScheme scheme, int n_long) {
    setup.scheme = scheme;
    FractionalStep flow(setup, blocks);
    FlowState state = flow.initial_state(), next;
    const double step = end / 3 / n_long;
    for (int n = 0; n < 12 * n_long; ++n) {
      flow.advance(state, n < n_long || n >= 11 * n_long ? step : step / 10, next);
      std::swap(state, next);
    }
    return state;
  };
  const FlowState truth = run(TimeScheme::adams_bashforth, 160);  // the most exact of the three here
  std::vector<double> errors;
  for (const int n_long : {20, 40}) {
    const FlowState state = run(GetParam(), n_long);
    double largest = 0;
    const Triple sizes = blocks.mine().sizes();
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < sizes[2]; ++k)
        for (int j = 0; j < sizes[1]; ++j)
          for (int i = 0; i < sizes[0]; ++i)
            largest = std::max(largest, std::abs(state.velocity[c](i, j, k) - truth.velocity[c](i, j, k)));
    MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    errors.push_back(largest);
  }
  EXPECT_GE(order_between(errors[0], errors[1]), 1.9);
}

INSTANTIATE_TEST_SUITE_P(Schemes, FlowOrderInTime,
                         testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                         TimeScheme::crank_nicolson));

}  // namespace
}  // namespace couplet::flow
