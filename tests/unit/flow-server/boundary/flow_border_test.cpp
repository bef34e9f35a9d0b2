#include "flow-server/boundary/flow_border.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::flow {
namespace {

/// Four by four cells of width 0.25 on one rank, the third direction without flow.
struct Square {
  StretchedGrid grid{{StretchedAxis(uniform_faces(0, 1, 4), false), StretchedAxis(uniform_faces(0, 1, 4), false),
                      StretchedAxis(uniform_faces(0, 2, 1), false)},
                     2};
  BlockDecomposition blocks{MPI_COMM_SELF, {equal_parts(4, 1, 1), equal_parts(4, 1, 1), equal_parts(1, 1, 1)}, {}};
  VectorField velocity{Field<double>({4, 4, 1}, {2, 2, 0}), Field<double>({4, 4, 1}, {2, 2, 0}), {}};

  FlowBorder with(const BorderConditions& conditions, bool balances = false) {
    return FlowBorder(grid, blocks, conditions, {}, balances);
  }
  void fill(double u, double v) {
    for (std::size_t i = 0; i < velocity[0].n_values(); ++i) velocity[0].data()[i] = u, velocity[1].data()[i] = v;
  }
};

PrescribedVelocity moving(double u, double v) {
  return {{SpaceTimeValue(u), SpaceTimeValue(v), SpaceTimeValue(0.0)}};
}

TEST(FlowBorder, TakesTheLastPatchThatContainsAFaceAndElseAWall) {
  Square square;
  BorderConditions conditions;
  conditions[0][0] = {FacePatch{.name = "all", .from = {0, 0.2, 0}, .to = {0, 1, 2}, .condition = SlipWall{}},
                      FacePatch{.name = "top", .from = {0, 0.7, 0}, .to = {0, 1, 2}, .condition = PressureOpening{}}};
  const FlowBorder border = square.with(conditions);
  EXPECT_EQ(border.kind(0, 0, {0, 0, 0}), BorderKind::prescribed);
  EXPECT_EQ(border.kind(0, 0, {0, 1, 0}), BorderKind::slip);
  EXPECT_EQ(border.kind(0, 0, {0, 3, 0}), BorderKind::opening);
  EXPECT_TRUE(border.is_partly_open(0, 0));
  EXPECT_FALSE(border.is_all_open(0, 0));
  EXPECT_FALSE(border.is_partly_open(0, 1));
}

TEST(FlowBorder, GhostsMakeTheWallsVelocityTheMeanOfAParabola) {
  Square square;
  BorderConditions conditions;
  conditions[1][0] = {FacePatch{.name = "belt", .condition = moving(3, 0)}};
  conditions[1][1] = {FacePatch{.name = "mirror", .condition = SlipWall{}}};
  FlowBorder border = square.with(conditions);
  square.fill(1, 0);
  border.set_time(0, 0, square.velocity);
  border.impose(square.velocity);
  border.fill_velocity_ghosts(square.velocity);
  EXPECT_NEAR(square.velocity[0](1, -1, 0), (8 * 3 - 6 * 1 + 1) / 3.0, 1e-14);
  EXPECT_EQ(square.velocity[0](1, 4, 0), 1);
  EXPECT_EQ(square.velocity[0](-1, 2, 0), 0);  // walls at the ends
  EXPECT_EQ(square.velocity[0](3, 2, 0), 0);
}

TEST(FlowBorder, OpeningsTakeFluidInStraight) {
  Square square;
  BorderConditions conditions;
  conditions[0][0] = {FacePatch{.name = "open", .condition = PressureOpening{5.0}}};
  FlowBorder border = square.with(conditions);
  for (const double u : {1.0, -1.0}) {  // in, out
    square.fill(u, 0.5);
    border.begin_step(square.velocity);
    border.set_pressure_time(0);
    border.set_time(0, 0, square.velocity);
    border.fill_velocity_ghosts(square.velocity);
    EXPECT_EQ(square.velocity[1](-1, 1, 0), u > 0 ? 0 : 0.5);
  }
  Field<double> pressure({4, 4, 1}, {2, 2, 0});
  border.fill_pressure_ghosts(pressure);
  EXPECT_EQ(pressure(-1, 2, 0), 5);
  EXPECT_EQ(pressure(4, 2, 0), 0);
}

TEST(FlowBorder, GhostsOfAChangeAreTheChangeOfTheGhosts) {
  Square square, sum, change;
  BorderConditions conditions;
  conditions[0][0] = {FacePatch{.name = "open", .condition = PressureOpening{5.0}}};
  conditions[1][0] = {FacePatch{.name = "belt", .condition = moving(3, 0)}};
  conditions[1][1] = {FacePatch{.name = "mirror", .condition = SlipWall{}}};
  FlowBorder border = square.with(conditions);
  for (const double u : {1.0, -1.0}) {  // through the opening: in, out
    for (int c = 0; c < 2; ++c)
      for (std::size_t i = 0; i < square.velocity[0].n_values(); ++i) {
        square.velocity[c].data()[i] = u + 0.1 * std::sin(1.0 + static_cast<double>(i) + c);
        change.velocity[c].data()[i] = 0.1 * std::cos(2.0 + static_cast<double>(i) + c);
        sum.velocity[c].data()[i] = square.velocity[c].data()[i] + change.velocity[c].data()[i];
      }
    border.begin_step(square.velocity);
    border.set_time(0, 0, square.velocity);
    border.fill_velocity_ghosts(square.velocity);
    border.fill_velocity_ghosts(sum.velocity);
    border.fill_change_ghosts(square.velocity, change.velocity);
    for (int c = 0; c < 2; ++c)
      for (std::size_t i = 0; i < square.velocity[0].n_values(); ++i)
        EXPECT_NEAR(change.velocity[c].data()[i], sum.velocity[c].data()[i] - square.velocity[c].data()[i], 1e-14);
  }
}

TEST(FlowBorder, BackflowThroughAnExitBringsHalfOfItsMomentum) {
  Square square;
  BorderConditions conditions;
  conditions[0][1] = {FacePatch{.name = "exit", .condition = PressureOpening{0.0}}};
  FlowBorder border = square.with(conditions);
  square.fill(2, 0);
  square.velocity[0](3, 1, 0) = -0.5;  // comes back in an exit that lets fluid out as a whole
  border.begin_step(square.velocity);
  border.fill_velocity_ghosts(square.velocity);
  const auto outer_flux = [&](int j) {
    const double sum = square.velocity[0](3, j, 0) + square.velocity[0](4, j, 0);
    return 0.25 * sum * sum;
  };
  EXPECT_NEAR(outer_flux(0), 4, 1e-14);
  EXPECT_NEAR(outer_flux(1), 0.5 * 0.25, 1e-14);
}

TEST(FlowBorder, OutflowsCarryOutWhatFlowsIn) {
  Square square;
  BorderConditions conditions;
  conditions[0][0] = {FacePatch{.name = "inlet", .condition = moving(1.5, 0)}};
  conditions[0][1] = {
      FacePatch{.name = "exit", .from = {0, 0.5, 0}, .to = {1, 1, 2}, .condition = ConvectiveOutflow{}}};
  FlowBorder border = square.with(conditions);
  square.fill(1, 0);
  border.begin_step(square.velocity);
  border.set_time(0.1, 0.1, square.velocity);
  border.impose(square.velocity);
  EXPECT_NEAR(border.net_inflow(), 1.5 * 2, 1e-14);
  double out = 0;
  for (int j = 0; j < 4; ++j) out += square.velocity[0](3, j, 0) * 0.25 * 2;
  EXPECT_NEAR(out, 3, 1e-14);
  EXPECT_EQ(square.velocity[0](3, 0, 0), 0);  // the wall below the exit
}

TEST(FlowBorder, BalancedInflowLeavesWallsClosed) {
  Square square;
  BorderConditions conditions;
  conditions[0][0] = {FacePatch{.name = "inlet", .condition = moving(1, 0)}};
  conditions[0][1] = {FacePatch{.name = "outlet", .condition = moving(0.5, 0)}};
  FlowBorder border = square.with(conditions, true);
  border.set_time(0, 0, square.velocity);
  border.impose(square.velocity);
  EXPECT_NEAR(square.velocity[0](-1, 1, 0), square.velocity[0](3, 1, 0), 1e-14);  // as much in as out
  EXPECT_NEAR(square.velocity[0](-1, 1, 0), 2.0 / 3, 1e-14);
  EXPECT_EQ(square.velocity[1](1, 3, 0), 0);
}

}  // namespace
}  // namespace couplet::flow
