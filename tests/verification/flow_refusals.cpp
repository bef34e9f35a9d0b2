// What the flow refuses, on all ranks alike and with the number that is wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const double pi = std::numbers::pi;
const std::vector<double> one_cell = uniform_faces(0, 1, 1);

/// Runs `body` and gives back what it complains of.
template <class Failure, class Body>
std::string complaint_of(const Body& body) {
  try {
    body();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "no complaint";
}

NavierStokesSetup filled_box(double inflow) {
  NavierStokesSetup setup =
      setup_on(box_grid({uniform_faces(0, 1, 8), uniform_faces(0, 2, 8), one_cell}, {false, false, false}, 2),
               TimeScheme::runge_kutta);
  PrescribedVelocity inlet;
  inlet.velocity[0] = inflow;
  setup.border[0][0] = {FacePatch{.name = "inlet", .condition = inlet}};
  return setup;
}

TEST(RefusedFlow, WithNetInflowAndNoWayOutNamesTheNumber) {
  NavierStokesSetup setup = filled_box(0.25);
  const BlockDecomposition blocks = decompose(setup.grid);
  EXPECT_THAT(complaint_of<report::SceneError>([&] { FractionalStep(setup, blocks).initial_state(); }),
              AllOf(HasSubstr("net 0.5 m^3/s"), HasSubstr("no way out")));
  setup.balances_inflow = true;
  FractionalStep flow(setup, blocks);
  FlowState start = flow.initial_state(), end;
  const AdvanceReport report = flow.advance(start, 0.1, end);
  EXPECT_DOUBLE_EQ(report.net_inflow, 0.5);
  EXPECT_LE(report.largest_speed, 1e-12);  // nothing is left of an inflow that has no way out
}

TEST(RefusedFlow, WithANumberThatIsNoneInATimeTableNamesPatchAndTime) {
  for (const bool has_exit : {false, true}) {
    NavierStokesSetup setup = filled_box(0);
    PrescribedVelocity inlet;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    inlet.velocity[0] = scene::TimeTable{.time = {0, 0.15, 0.2}, .value = {0, 0, nan}};
    setup.border[0][0] = {FacePatch{.name = "inlet", .condition = inlet}};
    if (has_exit) setup.border[0][1] = {FacePatch{.name = "exit", .condition = PressureOpening{0.0}}};
    const BlockDecomposition blocks = decompose(setup.grid);
    FractionalStep flow(setup, blocks);
    FlowState state = flow.initial_state(), next;
    flow.advance(state, 0.1, next);
    EXPECT_THAT(complaint_of<report::NumericsError>([&] { flow.advance(next, 0.1, state); }),
                AllOf(HasSubstr("patch inlet"), HasSubstr("not a number")));
  }
}

TEST(RefusedFlow, WithAVelocityThatIsNoNumberNamesThePlace) {
  NavierStokesSetup setup = filled_box(0);
  setup.body_force[0] = SpaceTimeValue([](const Point& p, double t) {
    return t > 0.01 && p[0] > 0.7 && p[0] < 0.8 && p[1] < 0.2 ? std::numeric_limits<double>::infinity() : 0.0;
  });
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  EXPECT_THAT(
      complaint_of<report::NumericsError>([&] { flow.advance(state, 0.1, next); }),
      AllOf(HasSubstr("cell ("), HasSubstr(" 0, 0) at ("), HasSubstr("m: the velocity at t = 0.1 s is not a number")));
}

TEST(RefusedFlow, WithTooSmallStepsNamesCellAndSpeed) {
  NavierStokesSetup setup = filled_box(0);
  setup.initial_velocity[0] = SpaceTimeValue([](const Point& p, double) { return 30 * std::sin(2 * pi * p[1]); });
  setup.step.smallest = 0.01;
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  EXPECT_THAT(complaint_of<report::NumericsError>([&] { flow.advance(state, 0.1, next); }),
              AllOf(HasSubstr("cell ("), HasSubstr("m/s asks for steps of"), HasSubstr("0.01 s")));
}

TEST(RefusedFlow, WithAConditionOnAPeriodicAxisNamesIt) {
  NavierStokesSetup setup = filled_box(0.25);
  setup.grid = box_grid({uniform_faces(0, 1, 8), uniform_faces(0, 2, 8), one_cell}, {true, false, false}, 2);
  const BlockDecomposition blocks = decompose(setup.grid);
  EXPECT_THAT(complaint_of<report::SceneError>([&] { FractionalStep(setup, blocks); }),
              AllOf(HasSubstr("border x start, patch inlet"), HasSubstr("periodic")));
}

}  // namespace
}  // namespace couplet::flow
