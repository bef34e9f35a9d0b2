// Rules of the flow in two and three dimensions: exact lines.

#include <gmock/gmock.h>

#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::string good_flow = R"scene(title: "a channel"
time { end: 1  step: 0.01 }
flow {
  fluid { density: 1  viscosity: 0.01 }
  navier_stokes {
    grid {
      x { stretched { start: 0 end: 4 region { start: 1 end: 2 width: 0.05 } region { start: 3 end: 3.5 width: 0.1 } } }
      y { uniform { start: 0 end: 1 cells: 32 } }
      z { faces { face: [0, 0.25, 0.5, 0.75, 1] } periodic: true }
    }
    border {
      x_start { velocity { expression { x: "y*(1-y)" } } }
      x_end { pressure { constant: 0 } }
      y_end {
        no_slip_wall { velocity { x: 1 } }
        patch { name: "vent" box { x_from: 1 x_to: 2 } convective_outflow { } }
      }
    }
    body_force { in_time { table { row { time: 0 value: 1 } } direction { x: 1 } } }
    initial { velocity { x: "sin(pi*y)" } }
    smallest_step: 1e-6
    largest_step: 0.005
    decomposition { y: 4 }
    field { box { z_to: 0.6 } quantity: [VELOCITY, VORTICITY] }
    plane { name: "inlet" normal: X position: 0.1 }
    probe { name: "wake" at { x: 2.5 y: 0.5 z: 0.5 } }
    integral_quantities: true
  }
}
output { results_interval: 0.1 }
)scene";

std::vector<std::string> flow_complaints_with(const std::string& part, const std::string& replacement) {
  return complaints_about(with(part, replacement, good_flow));
}

std::string in_flow(int line, int column, const std::string& path, const std::string& sentence) {
  return "scene.txtpb:" + std::to_string(line) + ":" + std::to_string(column) + ": flow.navier_stokes." + path + ": " +
         sentence;
}

TEST(NavierStokesRules, TakeAGoodFlow) {
  EXPECT_THAT(complaints_about(good_flow), IsEmpty());
}

TEST(NavierStokesRules, WantAxesThatRise) {
  EXPECT_THAT(flow_complaints_with("start: 0 end: 1 cells: 32", "start: 1 end: 1 cells: 32"),
              ElementsAre(in_flow(8, 30, "grid.y.uniform.end", "1 m is not above start, 1 m; give an end above it")));
  EXPECT_THAT(flow_complaints_with("[0, 0.25, 0.5, 0.75, 1]", "[0, 0.25, 0.2, 0.75, 1]"),
              ElementsAre(in_flow(9, 35, "grid.z.faces.face[2]",
                                  "0.2 m is not above the face before, 0.25 m; give faces in rising order")));
}

TEST(NavierStokesRules, WantFineRegionsInOrder) {
  EXPECT_THAT(
      flow_complaints_with("region { start: 3", "region { start: 1.5"),
      ElementsAre(in_flow(7, 87, "grid.x.stretched.region[1].start",
                          "1.5 m is below the end of the region before, 2 m; give regions in rising order, without "
                          "overlap")));
  EXPECT_THAT(flow_complaints_with("end: 3.5 width", "end: 5 width"),
              ElementsAre(in_flow(7, 96, "grid.x.stretched.region[1].end",
                                  "5 m is above the end of the axis, 4 m; give regions inside the axis")));
}

TEST(NavierStokesRules, RefuseABorderOfAPeriodicDirection) {
  EXPECT_THAT(
      flow_complaints_with("x_end { pressure { constant: 0 } }", "z_end { slip_wall { } }"),
      ElementsAre(in_flow(13, 7, "border.z_end", "has a condition, but z is periodic; delete it or grid.z.periodic")));
}

TEST(NavierStokesRules, RefuseWhatHasNoPlaceInTwoDimensions) {
  const std::string flat = with("      z { faces { face: [0, 0.25, 0.5, 0.75, 1] } periodic: true }\n", "", good_flow);
  EXPECT_THAT(complaints_about(flat), IsEmpty());
  EXPECT_THAT(complaints_about(with("x_end { pressure { constant: 0 } }", "z_end { slip_wall { } }", flat)),
              ElementsAre(in_flow(12, 7, "border.z_end",
                                  "is a border along z, but the grid has no z; delete it or give grid.z")));
  EXPECT_THAT(complaints_about(with("normal: X position: 0.1", "normal: Z position: 0.1", flat)),
              ElementsAre(in_flow(24, 27, "plane[0].normal", "Z is no direction of a grid without z; choose X or Y")));
  EXPECT_THAT(
      complaints_about(with("velocity { x: \"sin(pi*y)\" }", "exact { ethier_steinman { } }", flat)),
      ElementsAre(in_flow(19, 23, "initial.exact.ethier_steinman",
                          "is a flow in three dimensions, but the grid has no z; give grid.z or another flow")));
}

TEST(NavierStokesRules, WantPatchesWithTheirOwnNamesOnTheBorder) {
  const std::string vent = "patch { name: \"vent\" box { x_from: 1 x_to: 2 } convective_outflow { } }";
  EXPECT_THAT(flow_complaints_with(vent, vent + " " + vent),
              ElementsAre(in_flow(16, 89, "border.y_end.patch[1].name",
                                  "\"vent\" is the name of another patch; give each its own name")));
  EXPECT_THAT(flow_complaints_with("x_from: 1 x_to: 2 }", "x_from: 5 }"),
              ElementsAre(in_flow(16, 36, "border.y_end.patch[0].box.x_from",
                                  "5 m is beyond the end of the grid, 4 m; give a smaller one")));
  EXPECT_THAT(flow_complaints_with("x_from: 1 x_to: 2 }", "x_from: 2 x_to: 1 }"),
              ElementsAre(in_flow(16, 46, "border.y_end.patch[0].box.x_to",
                                  "1 m is not above x_from, 2 m; give a larger one")));
}

TEST(NavierStokesRules, WantAWallThatMovesInItsOwnPlane) {
  EXPECT_THAT(flow_complaints_with("velocity { x: 1 }", "velocity { y: 1 }"),
              ElementsAre(in_flow(15, 35, "border.y_end.no_slip_wall.velocity.y",
                                  "1 m/s leads through the wall; a wall moves in its own plane: delete y")));
}

TEST(NavierStokesRules, RefuseFormulasThatAreNoNumber) {
  EXPECT_THAT(
      flow_complaints_with("y*(1-y)", "sqrt(-y)"),
      ElementsAre(in_flow(12, 41, "border.x_start.velocity.expression.x",
                          "is nan at x = 0, y = 0.1, z = 0.1 m, t = 0 s; write a formula that is a finite number "
                          "everywhere")));
  EXPECT_THAT(
      flow_complaints_with("sin(pi*y)", "1/(y-0.5)"),
      ElementsAre(in_flow(20, 26, "initial.velocity.x",
                          "is inf at x = 0.4, y = 0.5, z = 0.1 m, t = 0 s; write a formula that is a finite number "
                          "everywhere")));
}

TEST(NavierStokesRules, RefuseTimeTablesThatAreNoNumber) {
  EXPECT_THAT(flow_complaints_with("row { time: 0 value: 1 }", "row { time: 0 value: nan }"),
              ElementsAre(in_flow(19, 50, "body_force.in_time.table.row[0].value",
                                  "nan is not a finite number; give a number")));
}

TEST(NavierStokesRules, WantBlocksWithCells) {
  EXPECT_THAT(flow_complaints_with("decomposition { y: 4 }", "decomposition { y: 9 }"),
              ElementsAre(in_flow(23, 21, "decomposition.y",
                                  "9 blocks share 32 cells along y; a block needs at least 4 of them")));
}

TEST(NavierStokesRules, WantStepsInOrder) {
  EXPECT_THAT(flow_complaints_with("smallest_step: 1e-6", "smallest_step: 0.5"),
              ElementsAre(in_flow(21, 5, "smallest_step", "0.5 s is above time.step, 0.01 s; give a smaller one"),
                          in_flow(21, 5, "smallest_step", "0.5 s is above largest_step, 0.005 s; give a smaller one")));
}

TEST(NavierStokesRules, WantPlanesAndProbesInsideWithTheirOwnNames) {
  EXPECT_THAT(flow_complaints_with("position: 0.1", "position: -1"),
              ElementsAre(in_flow(25, 37, "plane[0].position",
                                  "-1 m is outside the grid, which reaches from 0 to 4 m; give a place inside")));
  EXPECT_THAT(flow_complaints_with("y: 0.5 z: 0.5", "y: 1.5 z: 0.5"),
              ElementsAre(in_flow(26, 38, "probe[0].at.y",
                                  "1.5 m is outside the grid, which reaches from 0 to 1 m; give a place inside")));
  EXPECT_THAT(flow_complaints_with("probe { name: \"wake\"", "probe { name: \"inlet\""),
              ElementsAre(in_flow(26, 13, "probe[0].name",
                                  "\"inlet\" is the name of another plane, probe or balance; give each its own name")));
}

TEST(NavierStokesRules, WantMomentumBalancesInsideWithTheirOwnNames) {
  const std::string last = "    integral_quantities: true\n";
  const auto with_balance = [&](const std::string& balance) {
    return flow_complaints_with(last, "    momentum_balance { " + balance + " }\n");
  };
  EXPECT_THAT(with_balance("name: \"around\" box { x_from: 1 x_to: 3 }"), IsEmpty());
  EXPECT_THAT(with_balance("name: \"wake\" box { x_from: 1 }"),
              ElementsAre(in_flow(27, 24, "momentum_balance[0].name",
                                  "\"wake\" is the name of another plane, probe or balance; give each its own name")));
  EXPECT_THAT(with_balance("name: \"around\" box { x_from: 5 }"),
              ElementsAre(in_flow(27, 45, "momentum_balance[0].box.x_from",
                                  "5 m is beyond the end of the grid, 4 m; give a smaller one")));
}

TEST(NavierStokesRules, WantStoredFieldsThatAreStored) {
  EXPECT_THAT(
      flow_complaints_with("output { results_interval: 0.1 }\n", ""),
      ElementsAre(in_flow(24, 5, "field[0]",
                          "is never stored; give output.results_interval, the time between two stored states")));
  EXPECT_THAT(flow_complaints_with("[VELOCITY, VORTICITY]", "[VELOCITY, VELOCITY]"),
              ElementsAre(in_flow(24, 52, "field[0].quantity[1]", "VELOCITY stands there already; name each once")));
}

TEST(NavierStokesRules, RefuseAStartFromAFileThatIsNotThere) {
  EXPECT_THAT(
      flow_complaints_with("velocity { x: \"sin(pi*y)\" }", "file: \"no.h5\""),
      ElementsAre(in_flow(20, 15, "initial.file",
                          "the file \"no.h5\" does not exist; give a file, its path starting from the folder of the "
                          "scene")));
}

TEST(NavierStokesRules, WantAnExactFlowToCompareWith) {
  EXPECT_THAT(flow_complaints_with("integral_quantities: true", "compare_with { taylor_green { } }"),
              ElementsAre(in_flow(27, 20, "compare_with.taylor_green",
                                  "is exact in two dimensions only, but the grid has a z; delete it")));
}

}  // namespace
}  // namespace couplet::scene
