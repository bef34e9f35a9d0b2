// What a user reads when the text of a scene is wrong: exact lines.

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>

#include "proto/scene/read_scene.hpp"
#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(SceneText, GoodSceneHasNoComplaints) {
  EXPECT_THAT(complaints_about(good_scene), IsEmpty());
}

TEST(SceneText, BuildsTheMessageThatTheLibraryBuilds) {
  v1::Scene expected;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(good_scene, &expected));
  const v1::Scene read = read_scene_text(good_scene, "scene.txtpb", {}).file.scene;
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(read, expected));
}

TEST(SceneText, TakesEveryWayTheFormatWritesAValue) {
  const std::string text =
      with("fixed: [\"lateral\", \"anterior\"]",
           "fixed: 'later' \"al\"; fixed: [\"ante\\162ior\"], mass_damping: 5 points_per_element: 0x8", good_scene);
  const std::string scene = with("{ density: 1.13  viscosity: 1.8e-5 }", ": < density: 1f, viscosity: -0.0 >;", text);
  EXPECT_THAT(complaints_about(scene), IsEmpty());
  v1::Scene expected;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(scene, &expected));
  const v1::Scene read = read_scene_text(scene, "scene.txtpb", {}).file.scene;
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(read, expected));
  EXPECT_EQ(read.solid().body(0).fixed(1), "anterior");
}

TEST(SceneText, SuggestsTheNameNearestToAMisspeltField) {
  EXPECT_THAT(complaints_about(with("{ density: 1.13", "{ densty: 1.13")),
              ElementsAre("scene.txtpb:5:11: flow.fluid.densty: is not a field of Fluid; did you mean density?"));
}

TEST(SceneText, ListsTheFieldsWhenNoNameIsNear) {
  EXPECT_THAT(
      complaints_about(with("viscosity: 1.8e-5", "viscosity: 1.8e-5 colour: 3 kg")),
      ElementsAre("scene.txtpb:5:44: flow.fluid.colour: is not a field of Fluid; its fields are density, viscosity"));
}

TEST(SceneText, ChecksWhatIsInsideAMisspeltBlock) {
  EXPECT_THAT(complaints_about(with("fluid { density: 1.13", "fliud { density: -1")),
              ElementsAre("scene.txtpb:5:3: flow.fliud: is not a field of Flow; did you mean fluid?",
                          "scene.txtpb:5:11: flow.fluid.density: -1 is not above 0; give a value above 0 kg/m^3"));
}

TEST(SceneText, SaysNothingAboutTheInsideOfAnUnknownBlock) {
  EXPECT_THAT(
      complaints_about(with("fluid {", "colours { red: 1 green { dark: [1, { a: 2 }] } }\n  fluid {")),
      ElementsAre(
          "scene.txtpb:5:3: flow.colours: is not a field of Flow; its fields are fluid, glottis, navier_stokes"));
}

TEST(SceneText, SuggestsTheChoiceNearestToAMisspeltOne) {
  EXPECT_THAT(
      complaints_about(with("kind: FREQUENCY", "kind: FREQENCY")),
      ElementsAre(
          "scene.txtpb:39:33: output.quantity[0].kind: FREQENCY is not a choice here; did you mean FREQUENCY?"));
}

TEST(SceneText, ListsTheChoicesWhenSeveralAreNear) {
  EXPECT_THAT(complaints_about(with("model: M2", "model: M3")),
              ElementsAre("scene.txtpb:7:5: flow.glottis.model: M3 is not a choice here; choose B1, B2, M1, M2"));
}

TEST(SceneText, RefusesAChoiceInQuotes) {
  EXPECT_THAT(complaints_about(with("model: M2", "model: \"M2\"")),
              ElementsAre("scene.txtpb:7:5: flow.glottis.model: \"M2\" is text; write M2 without quotes"));
}

TEST(SceneText, PointsAtTheFieldEvenAtTheEndOfALine) {
  EXPECT_THAT(
      complaints_about(with("midplane: 0.0102", "unsteady: perhaps\n    midplane: 0.0102")),
      ElementsAre("scene.txtpb:14:5: flow.glottis.unsteady: perhaps is neither true nor false; give true or false"));
}

TEST(SceneText, CountsATabAsOneColumn) {
  EXPECT_THAT(complaints_about(with("    model: M2", "\t\tmodle: M2")),
              ElementsAre("scene.txtpb:7:3: flow.glottis.modle: is not a field of Glottis; did you mean model?"));
}

TEST(SceneText, RefusesTextForANumber) {
  EXPECT_THAT(complaints_about(with("midplane: 0.0102", "midplane: \"middle\"")),
              ElementsAre("scene.txtpb:14:5: flow.glottis.midplane: \"middle\" is not a number; give it in m"));
}

TEST(SceneText, RefusesANameForText) {
  EXPECT_THAT(complaints_about(with("name: \"fold\"", "name: fold")),
              ElementsAre("scene.txtpb:20:5: solid.body[0].name: fold is not in quotes; write \"fold\""));
}

TEST(SceneText, RefusesAFractionForAWholeNumber) {
  EXPECT_THAT(
      complaints_about(with("midplane: 0.0102", "midplane: 0.0102 stations: 140.5")),
      ElementsAre("scene.txtpb:14:22: flow.glottis.stations: 140.5 is not a whole number; leave out the point and "
                  "the exponent"));
}

TEST(SceneText, RefusesAWholeNumberThatIsTooLarge) {
  EXPECT_THAT(
      complaints_about(with("midplane: 0.0102", "midplane: 0.0102 stations: 3000000000")),
      ElementsAre(
          "scene.txtpb:14:22: flow.glottis.stations: 3000000000 is too large; whole numbers end at 2147483647"));
  EXPECT_THAT(
      complaints_about(with("midplane: 0.0102", "midplane: 0.0102 stations: -3000000000")),
      ElementsAre(
          "scene.txtpb:14:22: flow.glottis.stations: -3000000000 is too small; whole numbers end at -2147483648"));
}

TEST(SceneText, RefusesANumberThatOverflows) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 1e999")),
      ElementsAre(
          "scene.txtpb:23:7: solid.body[0].material.density: 1e999 is too large for a number; give it in kg/m^3"));
}

TEST(SceneText, RefusesAnOctalNumberForAPhysicalOne) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 01040")),
      ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: 01040 is no decimal number; write it without the "
                  "leading 0"));
}

TEST(SceneText, RefusesASecondValueOfAField) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 1040\n density: 1050")),
      ElementsAre("scene.txtpb:24:2: solid.body[0].material.density: is given a second time; it stands in line 23 "
                  "already, delete one of them"));
}

TEST(SceneText, RefusesASecondBlockOfAField) {
  EXPECT_THAT(
      complaints_about(with("coupling {", "time { end: 1 step: -1 } coupling {")),
      ElementsAre("scene.txtpb:32:1: time: is given a second time; it stands in line 2 already, delete one of them"));
}

TEST(SceneText, RefusesTwoMembersOfOneChoice) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 1040 mooney_rivlin { a10: 1 }")),
      ElementsAre(
          "scene.txtpb:23:21: solid.body[0].material.mooney_rivlin.a01: is missing; give it in Pa",
          "scene.txtpb:23:21: solid.body[0].material.mooney_rivlin.bulk_modulus: is missing; give it in Pa",
          "scene.txtpb:24:7: solid.body[0].material.saint_venant_kirchhoff: contradicts mooney_rivlin in line 23; give "
          "only one of saint_venant_kirchhoff, mooney_rivlin, neo_hookean, holzapfel_gasser_ogden or may_newman"));
}

TEST(SceneText, RefusesAUnitBehindANumber) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 1040 kg/m^3")),
      ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: \"kg\" stands behind the value; write one value, "
                  "without unit and arithmetic"));
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 1040kg")),
      ElementsAre("scene.txtpb:23:20: solid.body[0].material.density: the number runs into a name; numbers stand "
                  "without a unit, in SI units"));
}

TEST(SceneText, RefusesArithmetic) {
  EXPECT_THAT(
      complaints_about(with("step: 1e-5", "step: 1/2000")),
      ElementsAre(
          "scene.txtpb:2:18: time.step: \"/\" stands behind the value; write one value, without unit and arithmetic"));
}

TEST(SceneText, MissesAColonAndReadsOn) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density -1040")),
      ElementsAre(
          "scene.txtpb:23:7: solid.body[0].material.density: has no colon; write density: -1040",
          "scene.txtpb:23:7: solid.body[0].material.density: -1040 is not above 0; give a value above 0 kg/m^3"));
}

TEST(SceneText, TakesAnEqualsSignForAColonAndReadsOn) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density = 1040")),
      ElementsAre("scene.txtpb:23:15: solid.body[0].material.density: an equals sign stands where a colon should be; "
                  "write NAME: VALUE"));
}

TEST(SceneText, TakesAQuotedNameForANameAndReadsOn) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "\"density\": 1040")),
      ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: names stand without quotes; write density:"));
}

TEST(SceneText, MissesAValue) {
  EXPECT_THAT(complaints_about(with("density: 1040\n", "density:\n")),
              ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: has no value; give it in kg/m^3"));
  EXPECT_THAT(complaints_about(with("young_modulus: 15e3", "young_modulus:")),
              ElementsAre("scene.txtpb:24:32: solid.body[0].material.saint_venant_kirchhoff.young_modulus: has no "
                          "value; give it in Pa"));
}

TEST(SceneText, RefusesABlockForAValueAndAValueForABlock) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density { at: 20 value: 1040 }")),
      ElementsAre(
          "scene.txtpb:23:7: solid.body[0].material.density: is a single value and no block; give it in kg/m^3"));
  EXPECT_THAT(
      complaints_about(with("fluid { density: 1.13  viscosity: 1.8e-5 }", "fluid: \"air\"")),
      ElementsAre("scene.txtpb:5:3: flow.fluid: is a block and no single value; give fluid { ... }: the fluid"));
}

TEST(SceneText, RefusesAListForASingleField) {
  EXPECT_THAT(complaints_about(with("midplane: 0.0102", "midplane: [0.0102]")),
              ElementsAre("scene.txtpb:14:5: flow.glottis.midplane: is not a list; leave out the brackets"));
}

TEST(SceneText, NamesTheEntryOfAListThatIsWrong) {
  EXPECT_THAT(complaints_about(with("\"lateral\", \"anterior\"", "\"lateral\", anterior")),
              ElementsAre("scene.txtpb:26:24: solid.body[0].fixed[1]: anterior is not in quotes; write \"anterior\""));
}

TEST(SceneText, MissesACommaInAList) {
  EXPECT_THAT(
      complaints_about(with("\"lateral\", \"anterior\"", "\"lateral\" \"anterior\"")),
      ElementsAre("scene.txtpb:26:23: solid.body[0].fixed: a comma is missing before \"anterior\"; write [A, B, C]"));
}

TEST(SceneText, RefusesACommaTooMany) {
  EXPECT_THAT(
      complaints_about(with("\"lateral\", \"anterior\"", "\"lateral\", \"anterior\",")),
      ElementsAre("scene.txtpb:26:34: solid.body[0].fixed: a comma stands before the end of the list; delete it"));
  EXPECT_THAT(
      complaints_about(with("\"lateral\", \"anterior\"", "\"lateral\",, \"anterior\"")),
      ElementsAre("scene.txtpb:26:23: solid.body[0].fixed: an entry should stand here, not ,; write [A, B, C]"));
}

TEST(SceneText, MissesTheEndOfAList) {
  EXPECT_THAT(complaints_about(with("\"lateral\", \"anterior\"]", "\"lateral\", \"anterior\"")),
              ElementsAre("scene.txtpb:26:5: solid.body[0].fixed: its [ is not closed; add ]"));
}

TEST(SceneText, MissesAClosingQuote) {
  EXPECT_THAT(complaints_about(with("name: \"fold\"", "name: \"fold")),
              ElementsAre("scene.txtpb:20:16: solid.body[0].name: the closing quote is missing on this line; add it"));
}

TEST(SceneText, MissesAnExponent) {
  EXPECT_THAT(complaints_about(with("step: 1e-5", "step: 1e-")),
              ElementsAre("scene.txtpb:2:27: time.step: the exponent is missing behind e; write for example 1e-3"));
}

TEST(SceneText, RefusesCharactersThatAreNotAscii) {
  EXPECT_THAT(
      complaints_about(with("    model: M2", "    § 12\n    model: M2")),
      ElementsAre("scene.txtpb:7:5: flow.glottis: a character that is not ASCII stands here; such characters are "
                  "allowed in quotes only"));
}

TEST(SceneText, RefusesWhatIsNoField) {
  EXPECT_THAT(
      complaints_about(with("    model: M2", "    // the model\n    model: M2")),
      ElementsAre(
          "scene.txtpb:7:5: flow.glottis: a field should start here, not /; write NAME: VALUE or NAME { ... }"));
}

TEST(SceneText, FindsTheBlockThatIsNotClosedByItsIndentation) {
  EXPECT_THAT(
      complaints_about(with("      row { time: 0.02 value: 1000 }\n    }", "      row { time: 0.02 value: 1000 }")),
      ElementsAre("scene.txtpb:8:5: flow.glottis.subglottal_pressure: its { is not closed; add }"));
  EXPECT_THAT(complaints_about(with("    midplane: 0.0102\n  }\n}", "    midplane: 0.0102\n  }\n")),
              ElementsAre("scene.txtpb:4:1: flow: its { is not closed; add }"));
}

TEST(SceneText, FindsTheLastBlockThatIsNotClosed) {
  EXPECT_THAT(complaints_about(good_scene.substr(0, good_scene.size() - 2)),
              ElementsAre("scene.txtpb:37:1: output: its { is not closed; add }"));
}

TEST(SceneText, ChecksTheRestWhenAnUnclosedBlockIsFound) {
  EXPECT_THAT(
      complaints_about(
          with("    midplane: 0.0102\n  }\n}", "    midplane: 0.0102\n  }\n", with("density: 1040", "density: -1"))),
      ElementsAre("scene.txtpb:4:1: flow: its { is not closed; add }",
                  "scene.txtpb:23:7: solid.body[0].material.density: -1 is not above 0; give a value above 0 kg/m^3"));
}

TEST(SceneText, FindsTheBraceTooMany) {
  EXPECT_THAT(
      complaints_about(with("    midplane: 0.0102\n  }\n", "    midplane: 0.0102\n    }\n  }\n")),
      ElementsAre(
          "scene.txtpb:15:5: flow.glottis: this } closes nothing; delete it or add the brace that it should close"));
  EXPECT_THAT(complaints_about(good_scene + "}\n"),
              ElementsAre("scene.txtpb:41:1: this } closes nothing; delete it or add the brace that it should close"));
}

TEST(SceneText, ComplainsOfNothingButTheBracesWhenTheIndentationTellsNothing) {
  EXPECT_THAT(complaints_about("title: \"a\" flow { fluid { density: 1 viscosity: 1 glottis { model: M2 } }"),
              ElementsAre("scene.txtpb:1:12: flow: its { is not closed; add }"));
  EXPECT_THAT(complaints_about("title: \"a\" flow { fluid { density: 1 } viscosity: 1 } glottis { model: M2 } }"),
              ElementsAre("scene.txtpb:1:77: this } closes nothing; delete it or add the brace that it should close"));
}

TEST(SceneText, RefusesDifferentBracesAroundABlock) {
  EXPECT_THAT(
      complaints_about(with("medial_thickness: 1.75e-3 }", "medial_thickness: 1.75e-3 >")),
      ElementsAre("scene.txtpb:21:44: solid.body[0].vocal_fold: a block that { opens is closed by >; use { and }"));
}

TEST(SceneText, TakesTheMarkAndTheLineEndsOfOtherSystems) {
  std::string text = "\xEF\xBB\xBF" + with("density: 1040", "density: -1");
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', end + 2))
    text.insert(end, 1, '\r');
  EXPECT_THAT(
      complaints_about(text),
      ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: -1 is not above 0; give a value above 0 kg/m^3"));
}

TEST(SceneText, ComplainsInOneLineWhateverAValueHolds) {
  EXPECT_THAT(
      complaints_about(with("\"lateral\", \"anterior\"", "\"lat\\neral\"")),
      ElementsAre(
          "scene.txtpb:26:13: solid.body[0].fixed[0]: holds a line break, a tab or another invisible character; "
          "write one line of text",
          "scene.txtpb:26:13: solid.body[0].fixed[0]: the mesh has no surface \"lat?eral\"; did you mean "
          "lateral?"));
}

TEST(SceneText, RefusesWhatIsNoText) {
  EXPECT_THAT(complaints_about(std::string("\x89HDF\0\0\0", 7)),
              ElementsAre("scene.txtpb:1:1: this is not a text file; give a scene such as scene.txtpb"));
}

TEST(SceneText, ReportsEverythingAtOnceInTheOrderOfTheLines) {
  std::string text = with("title:", "titel:");
  text = with("step: 1e-5", "step: nan", text);
  text = with("density: 1.13", "densty: 1.13", text);
  text = with("model: M2", "model: M4", text);
  text = with("value: 1000", "value: inf", text);
  text = with("    midplane: 0.0102\n", "", text);
  text = with("poisson_ratio: 0.475", "poisson_ratio: 0.5", text);
  text = with("\"medial\"", "\"medail\"", text);
  text = with("y: \"0.6*(y/0.010)^2\"", "y: \"0.6*(y/0.010\"", text);
  EXPECT_THAT(
      complaints_about(text),
      ElementsAre(
          "scene.txtpb:1:1: titel: is not a field of Scene; did you mean title?",
          "scene.txtpb:2:18: time.step: nan is not a finite number; give it in s",
          "scene.txtpb:5:11: flow.fluid.densty: is not a field of Fluid; did you mean density?",
          "scene.txtpb:6:3: flow.glottis.midplane: is missing; give in m the position y of the plane midway between "
          "the folds",
          "scene.txtpb:7:5: flow.glottis.model: M4 is not a choice here; choose B1, B2, M1, M2",
          "scene.txtpb:10:24: flow.glottis.subglottal_pressure.row[1].value: inf is not a finite number; give a number",
          "scene.txtpb:23:53: solid.body[0].material.saint_venant_kirchhoff.poisson_ratio: 0.5 is not below 0.5; "
          "give a value between -1 and 0.5; for nearly incompressible tissue use mooney_rivlin",
          "scene.txtpb:26:26: solid.body[0].wetted[1]: the mesh has no surface \"medail\"; did you mean medial?",
          "scene.txtpb:28:33: solid.kick[0].velocity.y: the formula \"0.6*(y/0.010\" cannot be read at character 13: a "
          "closing parenthesis is missing; write it with x, y, z, t, pi, + - * / ^ and functions such as sin, exp, "
          "sqrt, abs"));
}

}  // namespace
}  // namespace couplet::scene
