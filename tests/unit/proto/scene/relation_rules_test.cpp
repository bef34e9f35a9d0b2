// Rules between fields: exact lines.

#include <gmock/gmock.h>

#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::string whole_flow =
    good_scene.substr(good_scene.find("flow {"), good_scene.find("solid {") - good_scene.find("flow {"));
const std::string whole_solid =
    good_scene.substr(good_scene.find("solid {"), good_scene.find("coupling {") - good_scene.find("solid {"));
const std::string whole_output = good_scene.substr(good_scene.find("output {"));
const std::string box = "box { length { x: 1 y: 1 z: 1 } }";

std::string flow_alone(const std::string& channel) {
  return with(whole_output, "", with(whole_solid, "", with("    midplane: 0.0102\n", channel)));
}

TEST(TimeRules, WantAFlowOrASolid) {
  EXPECT_THAT(
      complaints_about("title: \"a\" time { end: 1 step: 1 }"),
      ElementsAre("scene.txtpb:1:1: neither flow nor solid is given; give flow { ... }, solid { ... } or both"));
}

TEST(TimeRules, TakeASolidAlone) {
  EXPECT_THAT(complaints_about(with(whole_flow, "")), IsEmpty());
}

TEST(TimeRules, TakeAFlowAlone) {
  EXPECT_THAT(
      complaints_about(flow_alone("channel { length: 0.02 width: 0.02 height: \"0.001*(1+0.5*sin(2*pi*100*t))\" }")),
      IsEmpty());
}

TEST(TimeRules, RefuseAStepLongerThanTheRun) {
  EXPECT_THAT(
      complaints_about(with("step: 1e-5", "step: 0.6")),
      ElementsAre(
          "scene.txtpb:2:18: time.step: 0.6 s is longer than the run of 0.5 s; give a shorter step or a later end"));
}

TEST(TimeRules, RefuseARunWithoutEnd) {
  EXPECT_THAT(
      complaints_about(with("step: 1e-5", "step: 1e-300")),
      ElementsAre("scene.txtpb:2:18: time.step: 1e-300 s makes more than 1e+09 steps to the end at 0.5 s; give a "
                  "longer step or an earlier end"));
  EXPECT_THAT(complaints_about(with("step: 1e-5", "step: 1e-9")), IsEmpty());
}

TEST(TimeRules, TakeAStepThatDoesNotDivideTheRun) {
  EXPECT_THAT(complaints_about(with("step: 1e-5", "step: 0.3")), IsEmpty());
}

TEST(TimeRules, RefuseRowsThatDoNotRise) {
  const std::string expected =
      "scene.txtpb:10:13: flow.glottis.subglottal_pressure.row[1].time: 0 s is not later than the row before, 0 s; put "
      "the "
      "rows into rising order";
  EXPECT_THAT(complaints_about(with("time: 0.02 value", "time: 0 value")), ElementsAre(expected));
}

TEST(TimeRules, CheckTimeTablesWhereverTheyStand) {
  EXPECT_THAT(
      complaints_about(with("  kick {",
                            "  pressure { surface: \"medial\" value { row { time: 2 value: 1 } row { time: 1 value: "
                            "1 } } }\n  kick {")),
      ElementsAre("scene.txtpb:29:71: solid.pressure[0].value.row[1].time: 1 s is not later than the row before, 2 s; "
                  "put the rows into rising order"));
}

TEST(TimeRules, TakeAKickAfterTheEndOfTheRun) {
  EXPECT_THAT(complaints_about(with("time: 0.06", "time: 99")), IsEmpty());
}

TEST(SolidRules, RefuseSurfacesThatTheMeshDoesNotHave) {
  EXPECT_THAT(
      complaints_about(with("fixed: [\"lateral\"", "symmetry { surface: \"bottom\" normal: Z } fixed: [\"latral\"")),
      ElementsAre(
          "scene.txtpb:26:16: solid.body[0].symmetry[0].surface: the mesh has no surface \"bottom\"; it has "
          "lateral, inferior, medial, superior, anterior, posterior",
          "scene.txtpb:26:54: solid.body[0].fixed[0]: the mesh has no surface \"latral\"; did you mean lateral?"));
  EXPECT_THAT(
      complaints_about(
          with("  kick {", "  pressure { surface: \"medail\" value { row { time: 2 value: 1 } } }\n  kick {")),
      ElementsAre(
          "scene.txtpb:29:14: solid.pressure[0].surface: the mesh has no surface \"medail\"; did you mean medial?"));
}

TEST(SolidRules, KnowTheSurfacesOfABox) {
  const std::string text = with(whole_flow, "", with("vocal_fold { medial_thickness: 1.75e-3 }", box));
  const std::string scene = with("[\"inferior\", \"medial\", \"superior\"]", "\"x_max\"",
                                 with("\"lateral\", \"anterior\"", "\"x_min\", \"x_mid\"", text));
  EXPECT_THAT(
      complaints_about(with(whole_output, "", scene)),
      ElementsAre("scene.txtpb:12:22: solid.body[0].fixed[1]: the mesh has no surface \"x_mid\"; did you mean x_min?"));
}

TEST(SolidRules, RefuseAQuadratureThatDoesNotExist) {
  EXPECT_THAT(
      complaints_about(with("name: \"fold\"", "name: \"fold\" points_per_element: 9")),
      ElementsAre("scene.txtpb:20:18: solid.body[0].points_per_element: 9 is not 8, 14 or 27; choose 8, 14 or 27"));
  EXPECT_THAT(
      complaints_about(with("name: \"fold\"", "name: \"fold\" points_per_element: 28")),
      ElementsAre("scene.txtpb:20:18: solid.body[0].points_per_element: 28 is not at most 27; choose 8, 14 or 27"));
}

TEST(SolidRules, RefuseAHalfWithHalfAnElement) {
  const std::string half = with("midplane: 0.0102", "midplane: 0.0102 half_length: true");
  EXPECT_THAT(
      complaints_about(with("{ medial_thickness: 1.75e-3 }",
                            "{ medial_thickness: 1.75e-3 half_length: true elements_z: 13 }", half)),
      ElementsAre(
          "scene.txtpb:21:62: solid.body[0].vocal_fold.elements_z: 13 is odd, but half_length keeps half of the "
          "elements; give an even number"));
}

TEST(SolidRules, RefuseAFoldWithoutRoomForItsFaces) {
  EXPECT_THAT(
      complaints_about(with("medial_thickness: 1.75e-3", "medial_thickness: 0.0125")),
      ElementsAre("scene.txtpb:21:18: solid.body[0].vocal_fold.medial_thickness: 0.0125 m leaves no inferior face in a "
                  "fold of width 0.013 m; give less than 0.01216 m or a larger width"));
  EXPECT_THAT(
      complaints_about(with("medial_thickness: 1.75e-3", "medial_thickness: 1.75e-3 superior_fillet: 0.01")),
      ElementsAre(
          "scene.txtpb:21:44: solid.body[0].vocal_fold.superior_fillet: 0.01 m is not smaller than the depth of "
          "the fold, 0.01 m; give a smaller radius"));
}

TEST(FlowRules, WantTheWettedSurfaces) {
  EXPECT_THAT(
      complaints_about(with("    wetted: [\"inferior\", \"medial\", \"superior\"]\n", "")),
      ElementsAre("scene.txtpb:19:3: solid.body[0].wetted: is missing; name the surfaces that touch the flow, for "
                  "example wetted: [\"medial\"]"));
}

TEST(FlowRules, WantThePlaceOfTheGlottis) {
  const std::string text = with("    exit_line { marker: \"C2\" }\n    midplane: 0.0102\n", "");
  EXPECT_THAT(
      complaints_about(text),
      ElementsAre(
          "scene.txtpb:6:3: flow.glottis.midplane: is missing; give in m the position y of the plane midway "
          "between the folds",
          "scene.txtpb:6:3: flow.glottis.exit_line: is missing; give the material line of the exit, for example "
          "exit_line { marker: \"superior_fillet_middle\" }"));
}

TEST(FlowRules, WantTheEntranceOfM2) {
  const std::string text = with("    entrance_start { marker: \"inferior_middle\" }\n", "");
  EXPECT_THAT(
      complaints_about(text),
      ElementsAre("scene.txtpb:6:3: flow.glottis.entrance_start: is missing, but M2 needs it; give entrance_start { "
                  "marker: \"inferior_middle\" } or choose model M1"));
  EXPECT_THAT(complaints_about(with("model: M2", "model: M1", text)), IsEmpty());
}

TEST(FlowRules, WantAChannelWithoutASolid) {
  EXPECT_THAT(complaints_about(flow_alone("")),
              ElementsAre("scene.txtpb:6:3: flow.glottis.channel: is missing in a scene without "
                          "solid; give channel { ... } or solid { ... }"));
}

TEST(FlowRules, RefuseAChannelBesideASolid) {
  EXPECT_THAT(
      complaints_about(with("midplane: 0.0102", "midplane: 0.0102 channel { length: 0.02 width: 0.02 height: \"1\" }")),
      ElementsAre("scene.txtpb:14:22: flow.glottis.channel: contradicts solid, whose surface is the channel already; "
                  "delete channel or solid"));
}

TEST(FlowRules, RefuseMarkersThatTheMeshDoesNotHave) {
  EXPECT_THAT(
      complaints_about(with("\"C2\"", "\"C3\"")),
      ElementsAre(
          "scene.txtpb:13:17: flow.glottis.exit_line.marker: the mesh has no marker \"C3\"; it has inferior_middle, "
          "B1, B2, medial_middle, C1, superior_fillet_middle, C2"));
  EXPECT_THAT(
      complaints_about(with("\"inferior_middle\"", "\"inferior_midle\"")),
      ElementsAre(
          "scene.txtpb:12:22: flow.glottis.entrance_start.marker: the mesh has no marker \"inferior_midle\"; did you "
          "mean inferior_middle?"));
}

TEST(FlowRules, RefuseHalvesThatDisagree) {
  EXPECT_THAT(
      complaints_about(with("midplane: 0.0102", "midplane: 0.0102 half_length: true")),
      ElementsAre(
          "scene.txtpb:14:22: flow.glottis.half_length: true contradicts half_length of the vocal fold, false; set "
          "both to false"));
  EXPECT_THAT(
      complaints_about(with("medial_thickness: 1.75e-3", "medial_thickness: 1.75e-3 half_length: true")),
      ElementsAre(
          "scene.txtpb:6:3: flow.glottis.half_length: false contradicts half_length of the vocal fold, true; set "
          "both to true"));
}

TEST(CouplingRules, RefuseToAccelerateAnExplicitScheme) {
  EXPECT_THAT(
      complaints_about(with("  iqn_ils { }", "  scheme: EXPLICIT\n  iqn_ils { }")),
      ElementsAre(
          "scene.txtpb:34:3: coupling.iqn_ils: contradicts scheme EXPLICIT, which does not iterate; delete it or "
          "choose SERIAL_IMPLICIT"));
}

TEST(CouplingRules, WantALimitForConvergence) {
  EXPECT_THAT(
      complaints_about(with("  relative: 1e-5", "")),
      ElementsAre(
          "scene.txtpb:34:3: coupling.convergence[0]: has no limit; give absolute (SI unit of the field), relative "
          "or both"));
}

TEST(CouplingRules, RefuseAFieldThatTheInterfaceDoesNotHave) {
  EXPECT_THAT(
      complaints_about(with("field: \"displacement\"", "field: \"displacment\"")),
      ElementsAre(
          "scene.txtpb:34:17: coupling.convergence[0].field: \"displacment\" is not a field of the interface; did "
          "you mean displacement?"));
  EXPECT_THAT(
      complaints_about(with("field: \"displacement\"", "field: \"temperature\"")),
      ElementsAre("scene.txtpb:34:17: coupling.convergence[0].field: \"temperature\" is not a field of the interface; "
                  "choose force, displacement, velocity"));
}

TEST(OutputRules, RefuseNamesThatStandTwice) {
  EXPECT_THAT(
      complaints_about(with("  quantity {", "  probe { name: \"exit\" at { marker: \"B2\" } }\n  quantity {")),
      ElementsAre(
          "scene.txtpb:39:11: output.probe[1].name: \"exit\" is the name of another probe; give each its own name"));
  EXPECT_THAT(
      complaints_about(with("column: \"exit.y\" }",
                            "column: \"exit.y\" }\n quantity { name: \"frequency\" kind: FINAL column: \"a\" }")),
      ElementsAre(
          "scene.txtpb:40:13: output.quantity[1].name: \"frequency\" is the name of another quantity; give each its "
          "own name"));
}

TEST(OutputRules, RefuseAProbeWithoutASolid) {
  const std::string text = flow_alone("channel { length: 0.02 width: 0.02 height: \"1\" }");
  EXPECT_THAT(
      complaints_about(text + "output { probe { name: \"a\" at { marker: \"C1\" } } }"),
      ElementsAre("scene.txtpb:22:10: output.probe[0]: is a point of the solid, but the scene has none; delete it"));
}

TEST(OutputRules, RefuseAMarkerOnABox) {
  const std::string text = with(whole_flow, "", with("vocal_fold { medial_thickness: 1.75e-3 }", box));
  const std::string scene =
      with("    fixed: [\"lateral\", \"anterior\"]\n    wetted: [\"inferior\", \"medial\", \"superior\"]\n", "", text);
  EXPECT_THAT(
      complaints_about(scene),
      ElementsAre(
          "scene.txtpb:22:30: output.probe[0].at.marker: the mesh has no marker \"C1\"; give position { x: ... y: ... "
          "z: ... } instead"));
}

TEST(OutputRules, WantTheReferenceOfAPhase) {
  EXPECT_THAT(
      complaints_about(with("kind: FREQUENCY", "kind: PHASE_DELAY")),
      ElementsAre(
          "scene.txtpb:39:3: output.quantity[0].reference: is missing, but PHASE_DELAY needs it; name the column "
          "that the phase is measured against"));
}

TEST(OutputRules, RefuseTheColumnOfAProbeThatDoesNotExist) {
  EXPECT_THAT(
      complaints_about(with("column: \"exit.y\"", "column: \"exti.y\"")),
      ElementsAre(
          "scene.txtpb:39:50: output.quantity[0].column: \"exti.y\" is the column of a probe, but there is no probe "
          "\"exti\"; did you mean exit?"));
}

TEST(OutputRules, TakeTheReactionsOfSupports) {
  EXPECT_THAT(complaints_about(with("column: \"exit.y\"", "column: \"solid.reaction.lateral.y\"")), IsEmpty());
}

TEST(OutputRules, RefuseFieldsOfTheSolidThatStandTwiceOrAreNeverStored) {
  const std::string twice = with("solid {", "solid { field: CAUCHY_STRESS field: VOLUME_RATIO field: CAUCHY_STRESS");
  const std::string stored = with("output {", "output { results_interval: 1e-3", twice);
  EXPECT_THAT(complaints_about(stored), ElementsAre(testing::HasSubstr("solid.field[2]: CAUCHY_STRESS stands there "
                                                                       "already; name each once")));
  const std::string never = with("solid {", "solid { field: CAUCHY_STRESS");
  EXPECT_THAT(complaints_about(never), ElementsAre(testing::HasSubstr("solid.field[0]: is never stored; give "
                                                                      "output.results_interval")));
}

TEST(OutputRules, TakeColumnsThatOnlyTheServersKnow) {
  EXPECT_THAT(complaints_about(with("column: \"exit.y\"", "column: \"flow.rate\"")), IsEmpty());
}

TEST(OutputRules, RefuseAnEmptyRangeOfFrequencies) {
  EXPECT_THAT(
      complaints_about(with("kind: FREQUENCY", "kind: FREQUENCY frequency_to: 20")),
      ElementsAre(
          "scene.txtpb:39:49: output.quantity[0].frequency_to: the range of frequencies ends at 20 Hz but starts at "
          "20 Hz; give a frequency_to above frequency_from"));
  EXPECT_THAT(
      complaints_about(with("kind: FREQUENCY", "kind: FREQUENCY frequency_from: 2000")),
      ElementsAre("scene.txtpb:39:49: output.quantity[0].frequency_from: the range of frequencies ends at 1000 Hz but "
                  "starts at 2000 Hz; give a frequency_to above frequency_from"));
}

// A scene can be tried for a short time without touching its quantities and results.
TEST(OutputRules, LetARunBeShorterThanWhatIsAskedOfIt) {
  EXPECT_THAT(complaints_about(with("kind: FREQUENCY", "kind: FREQUENCY window: 0.6")), ElementsAre());
  EXPECT_THAT(complaints_about(with("  probe {", "  results_start: 0.6\n  probe {")), ElementsAre());
}

TEST(OutputRules, RefuseAWindowThatEndsAfterTheRun) {
  EXPECT_THAT(
      complaints_about(with("kind: FREQUENCY", "kind: FREQUENCY until: 0.6")),
      ElementsAre("scene.txtpb:39:49: output.quantity[0].until: 0.6 s is after the end of the run, 0.5 s; give an "
                  "earlier time"));
}

TEST(Relations, AreNotCheckedAgainstAWrongEnd) {
  EXPECT_THAT(complaints_about(with("end: 0.5", "end: -1", with("kind: FREQUENCY", "kind: FREQUENCY until: 0.2"))),
              ElementsAre("scene.txtpb:2:8: time.end: -1 is not above 0; give a value above 0 s"));
}

}  // namespace
}  // namespace couplet::scene
