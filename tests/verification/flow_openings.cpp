// Flow between openings: what the drive of a pressure must not depend on.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {
namespace {

const std::vector<double> one_cell = uniform_faces(0, 1, 1);

class EverySchemeBetweenOpenings : public testing::TestWithParam<TimeScheme> {};

FacePatch opening(SpaceTimeValue pressure) {
  return {.name = "open", .condition = PressureOpening{std::move(pressure)}};
}

/// A slit that is driven by a pressure which turns round, from the start of x or from its end.
NavierStokesSetup driven_slit(TimeScheme scheme, bool from_end, SpaceTimeValue drive) {
  NavierStokesSetup setup = setup_on(
      box_grid({uniform_faces(0, 2, 16), uniform_faces(0, 1, 12), one_cell}, {false, false, false}, 2), scheme);
  setup.viscosity = 0.05;
  setup.pressure.relative_tolerance = 1e-12;
  setup.pressure.divergence_tolerance = 1e-15;
  setup.border[0][from_end ? 1 : 0] = {opening(std::move(drive))};
  setup.border[0][from_end ? 0 : 1] = {opening(0.0)};
  return setup;
}

FlowState after(FractionalStep& step, int n_steps, double dt) {
  FlowState state = step.initial_state(), next;
  for (int n = 0; n < n_steps; ++n) {
    step.advance(state, dt, next);
    std::swap(state, next);
  }
  return state;
}

TEST_P(EverySchemeBetweenOpenings, BothEndsOfAnAxisAreAlike) {
  const scene::TimeTable turned{.time = {0, 0.3, 0.4, 1.5}, .value = {5, 5, -5, -5}};
  const NavierStokesSetup left = driven_slit(GetParam(), false, turned), right = driven_slit(GetParam(), true, turned);
  const BlockDecomposition blocks = decompose(left.grid, {1, 1, 1}, MPI_COMM_SELF);
  FractionalStep from_left(left, blocks), from_right(right, blocks);
  const FlowState a = after(from_left, 60, 0.02), b = after(from_right, 60, 0.02);
  double difference = 0;
  for (int j = 0; j < 12; ++j)
    for (int i = -1; i < 16; ++i)
      difference = std::max(difference, std::abs(a.velocity[0](i, j, 0) + b.velocity[0](14 - i, j, 0)));
  // Speeds of order 1; the same numbers in mirrored order differ by round-off.
  EXPECT_LT(difference, 1e-12);
}

TEST_P(EverySchemeBetweenOpenings, ConvergesInTimeUnderAnUnsteadyDrive) {
  const SpaceTimeValue drive([](const Point&, double t) { return 3 * std::sin(4 * t); });
  const NavierStokesSetup setup = driven_slit(GetParam(), false, drive);
  const BlockDecomposition blocks = decompose(setup.grid, {1, 1, 1}, MPI_COMM_SELF);
  const auto middle = [&](int n_steps) {
    FractionalStep step(setup, blocks);
    return after(step, n_steps, 0.8 / n_steps).velocity[0](7, 5, 0);
  };
  const double coarse = middle(160), medium = middle(320), fine = middle(640);
  // Differences of successive solutions fall as the error does. Crank-Nicolson advances the faces of openings beside
  // its lines, which costs it some of its second order there.
  const double order = GetParam() == TimeScheme::crank_nicolson ? 1.7 : 1.95;
  EXPECT_GE(std::log2(std::abs(coarse - medium) / std::abs(medium - fine)), order);
}

TEST_P(EverySchemeBetweenOpenings, AStepDoesNotDependOnWhatItsFieldsHeldBefore) {
  // Open all round, so that two openings meet in each corner.
  NavierStokesSetup setup = setup_on(
      box_grid({uniform_faces(0, 1, 12), uniform_faces(0, 1, 12), one_cell}, {false, false, false}, 2), GetParam());
  setup.viscosity = 0.01;
  for (int d = 0; d < 2; ++d)
    for (int side = 0; side < 2; ++side) setup.border[d][side] = {opening(0.0)};
  setup.initial_velocity[0] = SpaceTimeValue([](const Point& p, double) { return std::sin(7 * p[0] + 3 * p[1]); });
  setup.initial_velocity[1] = SpaceTimeValue([](const Point& p, double) { return std::cos(5 * p[0] - 6 * p[1]); });
  setup.body_force[0] = SpaceTimeValue([](const Point& p, double t) { return 20 * std::sin(9 * p[1] + 40 * t); });
  const BlockDecomposition blocks = decompose(setup.grid, {1, 1, 1}, MPI_COMM_SELF);
  FractionalStep step(setup, blocks);
  FlowState state = step.initial_state();
  int n_different = 0;
  for (int n = 0; n < 50; ++n) {
    FlowState fresh, used, after_fresh, after_used;
    step.advance(state, 0.01, fresh);
    step.advance(state, 0.025, used);
    step.advance(state, 0.01, used);
    step.advance(fresh, 0.01, after_fresh);
    step.advance(used, 0.01, after_used);
    for (int c = 0; c < 2; ++c)
      for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) n_different += after_fresh.velocity[c](i, j, 0) != after_used.velocity[c](i, j, 0);
    state = std::move(fresh);
  }
  EXPECT_EQ(n_different, 0);
}

TEST_P(EverySchemeBetweenOpenings, AFlowFromRestIsNotTakenInOneStep) {
  // 800 Pa on air at rest: within the interval it reaches some 20 m/s, 50 Courant numbers of a single step.
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 0.02, 64), uniform_faces(0, 0.005, 32), one_cell}, {false, false, false}, 2),
               GetParam());
  setup.density = 1.2;
  setup.viscosity = 1.8e-5;
  setup.border[0][0] = {opening(800.0)};
  setup.border[0][1] = {opening(0.0)};
  setup.is_fluid = [](const Point& p) { return p[0] < 0.008 || p[0] > 0.012 || std::abs(p[1] - 0.0025) < 0.0008; };
  const BlockDecomposition blocks = decompose(setup.grid, {1, 1, 1}, MPI_COMM_SELF);
  FractionalStep step(setup, blocks);
  FlowState once;
  const AdvanceReport report = step.advance(step.initial_state(), 2e-4, once);
  EXPECT_GT(report.n_steps, 10);
  EXPECT_LT(report.courant, 1.2 * 1.2);  // the largest limit of a scheme, and what a step may exceed it by
  const FlowState slowly = after(step, 40, 5e-6);
  // Errors of second order in steps of a Courant number: 0.1 % to 0.6 % were seen; 11 % and 160 % in one step.
  EXPECT_NEAR(once.largest_speed, slowly.largest_speed, 0.02 * slowly.largest_speed);
}

INSTANTIATE_TEST_SUITE_P(Schemes, EverySchemeBetweenOpenings,
                         testing::Values(TimeScheme::adams_bashforth, TimeScheme::runge_kutta,
                                         TimeScheme::crank_nicolson));

}  // namespace
}  // namespace couplet::flow
