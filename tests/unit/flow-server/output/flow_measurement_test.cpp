// Started on 1, 2 and 4 ranks.
#include "flow-server/output/flow_measurement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/unit/flow-server/state_from_formula.hpp"

namespace couplet::flow {
namespace {

constexpr double round_off = 1e-12;  // sums of some thousand numbers of order one
constexpr double infinity = std::numeric_limits<double>::infinity();

Formula constant(double value) {
  return [value](const Point&) { return value; };
}

TEST(FlowMeasurement, IntegratesAUniformStreamExactly) {
  const FormulaFlow flow(stretched_box({13, 11, 9}), {constant(1), constant(2), constant(-2)}, constant(0));
  const IntegralQuantities mine = integrate(flow.part(), 3, 0.1);
  EXPECT_NEAR(sum_of_ranks(mine.kinetic_energy), 0.5 * 3 * 9 * 4, 100 * round_off);  // rho/2 |u|^2 V, V = 2 x 2 x 1
  EXPECT_NEAR(sum_of_ranks(mine.dissipation), 0, round_off);
  EXPECT_NEAR(sum_of_ranks(mine.enstrophy), 0, round_off);
}

TEST(FlowMeasurement, IntegratesLinearFlowsExactly) {
  // u = 2 y, v = 0.5 x: shear rate 2.5, rotation -1.5; w = -z and u += x: 2 S:S gains 2 (1 + 1).
  const FormulaFlow flow(stretched_box({13, 11, 9}),
                         {[](const Point& x) { return 2 * x[1] + x[0]; }, [](const Point& x) { return 0.5 * x[0]; },
                          [](const Point& x) { return -x[2]; }},
                         constant(0));
  const IntegralQuantities mine = integrate(flow.part(), 1, 0.1);
  EXPECT_NEAR(sum_of_ranks(mine.dissipation), 0.1 * (2.5 * 2.5 + 2 * 2) * 4,
              1000 * round_off);  // differences over 1/30
  EXPECT_NEAR(sum_of_ranks(mine.enstrophy), 0.5 * 1.5 * 1.5 * 4, 1000 * round_off);
}

TEST(FlowMeasurement, CountsOnlyCellsThatHoldFluid) {
  const FormulaFlow flow(stretched_box({16, 12, 8}), {constant(2), constant(0), constant(0)}, constant(0),
                         [](const Point& x) { return x[2] < 0.5; });
  EXPECT_NEAR(sum_of_ranks(integrate(flow.part(), 1, 1).kinetic_energy), 0.5 * 4 * 2, 100 * round_off);
  PlaneCut plane{"cut", 0, 0.77, {-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  EXPECT_NEAR(sum_of_ranks(integrate(flow.part(), plane, 1).flow_rate), 2 * 2 * 0.5, 100 * round_off);
}

TEST(FlowMeasurement, ConvergesToTheDissipationOfTaylorGreenVortices) {
  // E = rho V^2 L^3 / 8 over a period of each axis and dissipation 6 nu E / L^2, to second order.
  constexpr double period = 2 * std::numbers::pi;
  const ExactFlow exact(TaylorGreenVortices{}, 1, 0.01);
  std::array<double, 2> error{};
  for (std::size_t level = 0; level < 2; ++level) {
    const int n = level == 0 ? 16 : 32;
    const StretchedAxis axis(uniform_faces(0, period, n), true);
    std::array<Formula, 3> velocity;
    for (std::size_t d = 0; d < 3; ++d) velocity[d] = [&exact, d](const Point& x) { return exact.velocity(x, 0)[d]; };
    const FormulaFlow flow({{axis, axis, axis}, 3}, velocity, constant(0));
    const IntegralQuantities mine = integrate(flow.part(), 1, 0.01);
    const double energy = sum_of_ranks(mine.kinetic_energy), dissipation = sum_of_ranks(mine.dissipation);
    EXPECT_NEAR(energy, period * period * period / 8, 1e-10);  // trapezoidal sums of waves are exact
    EXPECT_NEAR(dissipation, 2 * 0.01 * sum_of_ranks(mine.enstrophy), 1e-10);
    error[level] = std::abs(dissipation / (6 * 0.01 * energy) - 1);
  }
  EXPECT_LT(error[1], 0.01);
  EXPECT_GT(std::log2(error[0] / error[1]), 1.9);
}

TEST(FlowMeasurement, MeasuresPlanesBetweenFacesAndInsideBoxes) {
  // u = 1 + x z is linear along x and constant over the height of a cell's face.
  const FormulaFlow flow(stretched_box({13, 11, 9}),
                         {[](const Point& x) { return 1 + x[0] * x[2]; }, constant(0), constant(0)}, constant(0));
  PlaneCut plane{"cut", 0, 0.777, {-infinity, -0.3, 0.1}, {infinity, 0.55, 0.95}};
  // Cell values times overlaps: the integral of a step function, summed here directly.
  double expected = 0;
  const StretchedAxis& z = flow.grid.axis[2];
  for (int k = 0; k < z.n_cells(); ++k) {
    const double height = std::max(0.0, std::min(z.face(k + 1), 0.95) - std::max(z.face(k), 0.1));
    expected += 0.85 * height * (1 + 0.777 * z.centre(k));
  }
  EXPECT_NEAR(sum_of_ranks(integrate(flow.part(), plane, 1).flow_rate), expected, 10 * round_off);
}

TEST(FlowMeasurement, FindsPlanesAtBothEndsOfTheGrid) {
  const FormulaFlow flow(stretched_box({13, 11, 9}), {[](const Point& x) { return x[0]; }, constant(0), constant(0)},
                         constant(0));
  for (const double position : {0.0, 2.0}) {
    const PlaneCut plane{"end", 0, position, {-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
    const PlaneRates mine = integrate(flow.part(), plane, 3);
    EXPECT_NEAR(sum_of_ranks(mine.flow_rate), position * 2, 10 * round_off);
    EXPECT_NEAR(sum_of_ranks(mine.momentum_flux), 3 * position * position * 2, 100 * round_off);
  }
}

TEST(FlowMeasurement, ProbesAreExactForLinearFields) {
  const FormulaFlow flow(stretched_box({13, 11, 9}),
                         {[](const Point& x) { return x[0] + 2 * x[1] - x[2]; }, [](const Point& x) { return x[2]; },
                          [](const Point& x) { return 3 * x[0]; }},
                         [](const Point& x) { return x[0] - x[1] + 5 * x[2]; });
  for (const Point& at : {Point{0.5, 0.1, 0.4}, Point{1, 0, 0.5}, Point{1.93, 0.96, 0.9}, Point{0.03, -0.7, 0.08}}) {
    const PointValue mine = measure(flow.part(), {"p", at});
    EXPECT_NEAR(sum_of_ranks(mine.velocity[0]), at[0] + 2 * at[1] - at[2], 10 * round_off);
    EXPECT_NEAR(sum_of_ranks(mine.velocity[1]), at[2], 10 * round_off);
    EXPECT_NEAR(sum_of_ranks(mine.velocity[2]), 3 * at[0], 10 * round_off);
  }
  const PointValue inside = measure(flow.part(), {"p", {0.5, 0.1, 0.4}});
  EXPECT_NEAR(sum_of_ranks(inside.pressure), 0.5 - 0.1 + 2, 10 * round_off);
}

TEST(FlowMeasurement, PressureBesideABorderIsThatOfTheCell) {
  const FormulaFlow flow(stretched_box({8, 8, 8}), {constant(0), constant(0), constant(0)},
                         [](const Point& x) { return x[0]; });
  const PointValue mine = measure(flow.part(), {"wall", {0, 0, 0}});
  EXPECT_NEAR(sum_of_ranks(mine.pressure), flow.grid.axis[0].centre(0), round_off);
}

TEST(FlowMeasurement, SeesNoDistanceFromTheExactFlowItself) {
  const ExactFlow exact(EthierSteinmanFlow{}, 1, 0.1);
  std::array<Formula, 3> velocity;
  for (std::size_t d = 0; d < 3; ++d) velocity[d] = [&exact, d](const Point& x) { return exact.velocity(x, 0)[d]; };
  FormulaFlow flow(stretched_box({8, 10, 12}), velocity, [&](const Point& x) { return exact.pressure(x, 0); });
  const ErrorSums none = compare(flow.part(), exact);
  EXPECT_LT(sum_of_ranks(none.velocity_square), 1e-24);
  EXPECT_LT(sum_of_ranks(none.pressure_square), 1e-24);
  EXPECT_NEAR(sum_of_ranks(none.volume), 4, 10 * round_off);
  if (rank_of_test() == 0) flow.state.velocity[1](1, 1, 1) += 0.25;
  const ErrorSums one = compare(flow.part(), exact);
  double largest = one.largest_velocity;
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_NEAR(largest, 0.25, round_off);
}

}  // namespace
}  // namespace couplet::flow
