// Rules of the bodies in a flow: exact lines.

#include <gmock/gmock.h>

#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::string good_bodies = R"scene(title: "a bird"
time { end: 1  step: 0.01 }
flow {
  fluid { density: 1  viscosity: 0.01 }
  navier_stokes {
    grid {
      x { uniform { start: -2 end: 2 cells: 64 } }
      y { uniform { start: -2 end: 2 cells: 64 } }
      z { uniform { start: -2 end: 2 cells: 64 } }
    }
    body {
      name: "trunk"
      ellipsoid { radius: 1 radius_y: 0.3 radius_z: 0.3 }
      joint { translation { z { expression: "0.1*sin(2*pi*t)" } } }
    }
    body {
      name: "left"
      moves_with: "trunk"
      rectangle { corner { y: 0.3 } first_side { x: 0.5 } second_side { y: 1 } }
      joint { rotation { axis { x: 1 } angle { fourier { frequency: 1 cosine: [60, 2] sine: 5 } } } }
      joint { rotation { axis { y: 1 } angle { in_time { row { time: 0 value: 10 } row { time: 1 value: 20 } } } } }
      edge { attached { y_to: 0.31 } }
    }
    body { name: "wall" tube { start { x: -2 } end { x: 2 } radius: 1.9 } }
    body { name: "rod" cylinder { centre { y: 1 } radius: 0.1 } largest_triangle: 0.05 blend_width: 0.5 }
  }
}
)scene";

const std::string flat_bodies = R"scene(title: "a flag"
time { end: 1  step: 0.01 }
flow {
  fluid { density: 1  viscosity: 0.01 }
  navier_stokes {
    grid { x { uniform { start: 0 end: 4 cells: 64 } } y { uniform { start: 0 end: 1 cells: 16 } } }
    body {
      name: "flag"
      polygon { point { x: 1 y: 0.4 } point { x: 2 y: 0.4 } point { x: 2 y: 0.6 } point { x: 1 y: 0.6 } }
      joint { rotation { through { x: 1 y: 0.5 } angle { expression: "5*t" } } }
      placement { rotation_axis { z: 1 } rotation_angle: 5 }
    }
    body { name: "sheet" sheet { point { x: 3 } point { x: 3 y: 1 } } thickness: 0.1 }
  }
}
)scene";

std::vector<std::string> complaints_with(const std::string& part, const std::string& replacement,
                                         const std::string& scene = good_bodies) {
  return complaints_about(with(part, replacement, scene));
}

std::string at(int line, int column, const std::string& path, const std::string& sentence) {
  return "scene.txtpb:" + std::to_string(line) + ":" + std::to_string(column) + ": flow.navier_stokes.body" + path +
         ": " + sentence;
}

TEST(FlowBodyRules, TakeGoodBodies) {
  EXPECT_THAT(complaints_about(good_bodies), IsEmpty());
  EXPECT_THAT(complaints_about(flat_bodies), IsEmpty());
}

TEST(FlowBodyRules, WantNamesOfTheirOwn) {
  EXPECT_THAT(complaints_with("\"rod\"", "\"wall\""),
              ElementsAre(at(25, 12, "[3].name", "\"wall\" is the name of another body; give each its own name")));
}

TEST(FlowBodyRules, WantBodiesThatHangOnOthers) {
  EXPECT_THAT(complaints_with("moves_with: \"trunk\"", "moves_with: \"trank\""),
              ElementsAre(at(18, 7, "[1].moves_with", "there is no body \"trank\"; did you mean trunk?")));
  EXPECT_THAT(complaints_with("      ellipsoid {", "      moves_with: \"left\" ellipsoid {"),
              ElementsAre(at(13, 7, "[0].moves_with",
                             "\"left\" hangs on \"trunk\" in the end; leave out moves_with of the body that carries "
                             "the others"),
                          at(18, 7, "[1].moves_with",
                             "\"trunk\" hangs on \"left\" in the end; leave out moves_with of the body that carries "
                             "the others")));
}

TEST(FlowBodyRules, WantShapesThatAreSome) {
  EXPECT_THAT(complaints_with("second_side { y: 1 }", "second_side { x: 1 }"),
              ElementsAre(at(19, 7, "[1].rectangle",
                             "its sides are parallel or have no length; give two sides that span a plate")));
  EXPECT_THAT(complaints_with("end { x: 2 } radius", "end { x: -2 } radius"),
              ElementsAre(at(24, 48, "[2].tube.end", "lies where start lies; give the other end of the axis")));
  EXPECT_THAT(complaints_with("cylinder { centre { y: 1 } radius: 0.1 }", "cuboid { low { } high { x: 1 y: 1 } }"),
              ElementsAre(at(25, 41, "[3].cuboid.high.z", "0 m is not above that of low, 0 m; give a larger one")));
  EXPECT_THAT(
      complaints_with("point { x: 1 y: 0.6 } }", "point { x: 1 y: 0.6 } point { x: 1 y: 0.4 } }", flat_bodies),
      ElementsAre(at(9, 17, "[0].polygon.point[0]",
                     "lies where the point before lies; the last point is joined to the first by itself: delete "
                     "one of them")));
  EXPECT_THAT(
      complaints_with("point { x: 2 y: 0.6 } point { x: 1 y: 0.6 } }", "point { x: 3 y: 0.4 } }", flat_bodies),
      ElementsAre(at(9, 7, "[0].polygon", "its points enclose no area; give an outline around an area, or a sheet")));
}

TEST(FlowBodyRules, WantRoundBodiesThatAreClosed) {
  const std::string rod = "cylinder { centre { y: 1 } radius: 0.1 }";
  EXPECT_THAT(complaints_with(rod, "revolved { point { } point { x: 1 y: 0.2 } point { x: 2 } }"), IsEmpty());
  EXPECT_THAT(complaints_with(rod, "revolved { point { } point { x: 1 } point { x: 2 y: 0.1 } }"),
              ElementsAre(at(25, 45, "[3].revolved.point[1].y", "is 0 m; give a distance from the axis above 0"),
                          at(25, 73, "[3].revolved.point[2].y", "is 0.1 m, but the body ends here; give 0, the axis")));
}

TEST(FlowBodyRules, WantSheetsBetweenTwoEdges) {
  const std::string plate = "rectangle { corner { y: 0.3 } first_side { x: 0.5 } second_side { y: 1 } }";
  const auto complaints = [&](const std::string& first, const std::string& second) {
    return complaints_with(plate, "ruled_sheet { first_edge { y: 0.3 } first_edge { y: 1 } first_edge { y: 1.3 " +
                                      first + "} second_edge { x: 0.5 y: 0.3 } second_edge { x: 0.3 y: 1 } " + second +
                                      "}");
  };
  EXPECT_THAT(complaints("", "second_edge { y: 1.3 }"), IsEmpty());  // ends in a tip
  EXPECT_THAT(complaints("", ""), ElementsAre(testing::HasSubstr("has 2 points, first_edge 3; give both as many")));
  EXPECT_THAT(complaints("} first_edge { y: 2 ", "second_edge { y: 1.3 } second_edge { x: 1 y: 2 }"),
              ElementsAre(testing::HasSubstr("lies on the first edge, which parts the sheet in two")));
  EXPECT_THAT(complaints("", "second_edge { x: 0.3 y: 1 }"),
              ElementsAre(testing::HasSubstr("lies where the point before lies; delete this pair of points")));
}

TEST(FlowBodyRules, WantOutlinesThatDoNotCrossThemselves) {
  EXPECT_THAT(
      complaints_with("point { x: 2 y: 0.6 } point { x: 1 y: 0.6 } }",
                      "point { x: 1.2 y: 0.6 } point { x: 1.9 y: 0.7 } }", flat_bodies),
      ElementsAre(at(9, 85, "[0].polygon.point[3]",
                     "the side from here to the next point meets the side that starts at point[1]; give the points "
                     "in order around the body")));
}

TEST(FlowBodyRules, KeepAFlatFlowFlat) {
  EXPECT_THAT(
      complaints_with("sheet { point { x: 3 } point { x: 3 y: 1 } } thickness: 0.1", "ellipsoid { radius: 1 }",
                      flat_bodies),
      ElementsAre(at(13, 26, "[1].ellipsoid",
                     "is a shape in three dimensions, but the grid has no z; give cylinder, polygon or sheet, or "
                     "grid.z")));
  EXPECT_THAT(complaints_with("rotation_axis { z: 1 } ", "", flat_bodies),
              ElementsAre(at(11, 7, "[0].placement.rotation_axis",
                             "is not z, but the grid has no z to turn into; give rotation_axis { z: 1 }")));
  EXPECT_THAT(
      complaints_with("rotation_angle: 5", "translation { z: 0.5 }", flat_bodies),
      ElementsAre(at(11, 56, "[0].placement.translation.z", "0.5 m leads out of the plane of the flow; delete z")));
  EXPECT_THAT(
      complaints_with("rotation { through", "rotation { axis { x: 1 } through", flat_bodies),
      ElementsAre(at(10, 26, "[0].joint[0].rotation.axis", "is not z, but the grid has no z to turn into; delete it")));
}

TEST(FlowBodyRules, KeepEdgesForSheets) {
  EXPECT_THAT(
      complaints_with("largest_triangle: 0.05", "edge { } thickness: 0.1"),
      ElementsAre(at(25, 65, "[3].edge", "is for thin sheets, but this surface bounds a body; delete it"),
                  at(25, 74, "[3].thickness", "is for thin sheets, but this surface bounds a body; delete it")));
  EXPECT_THAT(complaints_with("attached { y_to: 0.31 }", "attached { y_to: 0.31 } all_attached: true"),
              ElementsAre(at(22, 14, "[1].edge.attached[0]",
                             "names some edges, but all_attached names all; delete one of them")));
}

TEST(FlowBodyRules, WantMotionsThatAreNumbersOverTime) {
  EXPECT_THAT(complaints_with("0.1*sin(2*pi*t)", "1/(t-0.5)"),
              ElementsAre(at(14, 33, "[0].joint[0].translation.z.expression",
                             "is inf at t = 0.5 s; write a formula that is a finite number at all times")));
  EXPECT_THAT(complaints_with("0.1*sin(2*pi*t)", "x*t"),
              ElementsAre(at(14, 33, "[0].joint[0].translation.z.expression",
                             "depends on the place; a rigid body moves as a whole: use t alone")));
  EXPECT_THAT(
      complaints_with("z { expression: \"0.1*sin(2*pi*t)\" }", ""),
      ElementsAre(at(14, 15, "[0].joint[0].translation", "moves nothing; give x, y or z, or delete the joint")));
  EXPECT_THAT(complaints_with("axis { x: 1 }", "axis { }"),
              ElementsAre(at(20, 26, "[1].joint[0].rotation.axis", "has no length; give a direction")));
  EXPECT_THAT(complaints_with("time: 1 value: 20", "time: 0 value: 20"),
              ElementsAre(at(21, 90, "[1].joint[1].rotation.angle.in_time.row[1].time",
                             "0 s is not later than the row before, 0 s; put the rows into rising order")));
}

TEST(FlowBodyRules, WantTheSolidInTheFlowOnce) {
  const std::string solid =
      "solid { body { name: \"block\" box { length { x: 1 y: 1 z: 1 } } material { density: 1 saint_venant_kirchhoff { "
      "young_modulus: 1 poisson_ratio: 0.3 } } wetted: [\"x_max\"] } }\n";
  const std::string coupled_scene = good_bodies + solid;
  EXPECT_THAT(complaints_about(coupled_scene),
              ElementsAre("scene.txtpb:5:3: flow.navier_stokes.body: the solid is not in the flow; give a body { name: "
                          "\"...\"  coupled { } }"));
  const std::string cylinder = "cylinder { centre { y: 1 } radius: 0.1 }";
  EXPECT_THAT(complaints_with(cylinder, "coupled { }", coupled_scene), IsEmpty());
  EXPECT_THAT(complaints_with(cylinder, "coupled { kind: THIN } edge { }", coupled_scene), IsEmpty());
  EXPECT_THAT(complaints_with(cylinder, "coupled { }"),
              ElementsAre(at(25, 24, "[3].coupled",
                             "there is no solid whose surface this could be; give solid or another shape")));
  EXPECT_THAT(
      complaints_with(cylinder, "coupled { } placement { } moves_with: \"trunk\"", coupled_scene),
      ElementsAre(at(25, 36, "[3].placement", "the solid says where its surface lies; delete it, or place solid.body"),
                  at(25, 50, "[3].moves_with", "the solid moves its surface; delete it")));
  EXPECT_THAT(complaints_with(cylinder, "coupled { } } body { name: \"second\" coupled { }", coupled_scene),
              ElementsAre(at(25, 60, "[4].coupled", "the solid is in the flow already; delete this body")));
}

TEST(FlowBodyRules, WantTheFileOfASurface) {
  EXPECT_THAT(
      complaints_with("cylinder { centre { y: 1 } radius: 0.1 }", "file { file: \"no.stl\" kind: CLOSED }"),
      ElementsAre(at(25, 31, "[3].file.file",
                     "the file \"no.stl\" does not exist; give a file, its path starting from the folder of the "
                     "scene")));
}

}  // namespace
}  // namespace couplet::scene
