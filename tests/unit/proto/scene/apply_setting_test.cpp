// --set PATH=VALUE

#include <gmock/gmock.h>

#include "proto/scene/read_scene.hpp"
#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

v1::Scene scene_with(const std::vector<std::string>& settings) {
  const ReadResult result = read_scene_text(good_scene, "scene.txtpb", settings);
  for (const Complaint& complaint : result.complaints) ADD_FAILURE() << complaint.text();
  return result.file.scene;
}

TEST(Setting, SetsANumberByItsPath) {
  EXPECT_EQ(scene_with({"time.step=2e-5"}).time().step(), 2e-5);
}

TEST(Setting, LastOneCounts) {
  EXPECT_EQ(scene_with({"time.step=2e-5", "time.step=4e-5"}).time().step(), 4e-5);
}

TEST(Setting, SetsEveryKindOfValue) {
  const v1::Scene scene =
      scene_with({"flow.glottis.model=M1", "flow.glottis.unsteady=false", "flow.glottis.stations=77",
                  "flow.glottis.exit_pressure=-100", "title=a new title", "solid.body[0].name=\"b\""});
  EXPECT_EQ(scene.flow().glottis().model(), v1::Glottis::M1);
  EXPECT_FALSE(scene.flow().glottis().unsteady());
  EXPECT_EQ(scene.flow().glottis().stations(), 77);
  EXPECT_EQ(scene.flow().glottis().exit_pressure(), -100);
  EXPECT_EQ(scene.title(), "a new title");
  EXPECT_EQ(scene.solid().body(0).name(), "b");
}

TEST(Setting, TakesTextWithQuotesAndBackslashesInside) {
  EXPECT_EQ(scene_with({R"(title=a "bent" \ fold)"}).title(), R"(a "bent" \ fold)");
  EXPECT_EQ(scene_with({R"(solid.kick[0].velocity.y=0.1*sin(pi*z/0.02))"}).solid().kick(0).velocity().y(),
            "0.1*sin(pi*z/0.02)");
}

TEST(Setting, ValueMayHoldEqualsSigns) {
  EXPECT_EQ(scene_with({"title=T=3.5"}).title(), "T=3.5");
}

TEST(Setting, GoesThroughTheChosenMemberOfAChoice) {
  const v1::Scene scene = scene_with({"solid.body[0].material.young_modulus=2e4", "solid.body[0].elements_z=20"});
  EXPECT_EQ(scene.solid().body(0).material().saint_venant_kirchhoff().young_modulus(), 2e4);
  EXPECT_EQ(scene.solid().body(0).vocal_fold().elements_z(), 20);
}

TEST(Setting, ReplacesAMemberOfAChoiceByAnother) {
  const v1::Scene scene = scene_with({"solid.body[0].material.mooney_rivlin={a10: 2290 a01: 250 bulk_modulus: 1e5}",
                                      "solid.body[0].material.a10=2300"});
  EXPECT_EQ(scene.solid().body(0).material().law_case(), v1::Material::kMooneyRivlin);
  EXPECT_EQ(scene.solid().body(0).material().mooney_rivlin().a10(), 2300);
}

TEST(Setting, ReplacesOneEntryOfAList) {
  const v1::Scene scene = scene_with({"solid.body[0].fixed[0]=posterior"});
  EXPECT_THAT(scene.solid().body(0).fixed(), ElementsAre("posterior", "anterior"));
}

TEST(Setting, AppendsAnEntryBehindTheLast) {
  const v1::Scene scene =
      scene_with({"solid.body[0].fixed[2]=posterior", "output.probe[1]={name: \"inlet\" at {marker: \"B2\"}}",
                  "output.probe[2].name=middle", "output.probe[2].at.marker=medial_middle"});
  EXPECT_THAT(scene.solid().body(0).fixed(), ElementsAre("lateral", "anterior", "posterior"));
  EXPECT_EQ(scene.output().probe(1).at().marker(), "B2");
  EXPECT_EQ(scene.output().probe(2).name(), "middle");
}

TEST(Setting, ReplacesAWholeList) {
  const v1::Scene scene = scene_with({"solid.body[0].fixed=[\"lateral\"]", "output.quantity=[]"});
  EXPECT_THAT(scene.solid().body(0).fixed(), ElementsAre("lateral"));
  EXPECT_THAT(scene.output().quantity(), IsEmpty());
}

TEST(Setting, AddsBlocksOnTheWay) {
  EXPECT_EQ(scene_with({"output.checkpoints.every_steps=100"}).output().checkpoints().every_steps(), 100);
}

TEST(Setting, MendsAScene) {
  EXPECT_THAT(complaints_about(with("density: 1040\n", "density: -1\n"), {"solid.body[0].material.density=1000"}),
              IsEmpty());
  EXPECT_THAT(complaints_about(with("density: 1040\n", "\n"), {"solid.body[0].material.density=1000"}), IsEmpty());
}

TEST(Setting, SuggestsTheNearestName) {
  EXPECT_THAT(complaints_about(good_scene, {"time.stp=1"}),
              ElementsAre("--set time.stp=1: stp is not a field of Time; did you mean step?"));
  EXPECT_THAT(
      complaints_about(good_scene, {"solid.body[0].material.yung_modulus=1"}),
      ElementsAre("--set solid.body[0].material.yung_modulus=1: yung_modulus is not a field of Material; did you mean "
                  "young_modulus?"));
  EXPECT_THAT(complaints_about(good_scene, {"time.colour=1"}),
              ElementsAre("--set time.colour=1: colour is not a field of Time; its fields are end, step"));
}

TEST(Setting, WithoutAValueTakesABlockOut) {
  EXPECT_TRUE(scene_with({}).has_coupling());
  EXPECT_FALSE(scene_with({"coupling="}).has_coupling());
}

TEST(Setting, SaysWhichMemberHasTheField) {
  EXPECT_THAT(
      complaints_about(good_scene, {"solid.body[0].material.a10=1"}),
      ElementsAre("--set solid.body[0].material.a10=1: a10 is a field of mooney_rivlin, which is not chosen; choose it "
                  "first with mooney_rivlin={ ... }"));
}

TEST(Setting, RefusesAWrongValue) {
  EXPECT_THAT(complaints_about(good_scene, {"flow.glottis.model=M7"}),
              ElementsAre("--set flow.glottis.model=M7: M7 is not a choice here; choose B1, B2, M1, M2"));
  EXPECT_THAT(complaints_about(good_scene, {"time.step=fast"}),
              ElementsAre("--set time.step=fast: fast is not a number; give it in s"));
  EXPECT_THAT(complaints_about(good_scene, {"time.step="}),
              ElementsAre("--set time.step=: has no value; give it in s"));
  EXPECT_THAT(
      complaints_about(good_scene, {"time.step=1e-5 s"}),
      ElementsAre(
          "--set time.step=1e-5 s: \"s\" stands behind the value; write one value, without unit and arithmetic"));
}

TEST(Setting, IsNamedWhenItsValueBreaksARule) {
  EXPECT_THAT(complaints_about(good_scene, {"solid.body[0].material.density=-1"}),
              ElementsAre("--set solid.body[0].material.density=-1: -1 is not above 0; give a value above 0 kg/m^3"));
  EXPECT_THAT(
      complaints_about(good_scene, {"solid.body[0].material.poisson_ratio=0.5"}),
      ElementsAre("--set solid.body[0].material.poisson_ratio=0.5: solid.body[0].material.saint_venant_kirchhoff."
                  "poisson_ratio: 0.5 is not below 0.5; give a value between -1 and 0.5; for nearly incompressible "
                  "tissue use mooney_rivlin"));
  EXPECT_THAT(
      complaints_about(good_scene, {"solid.body[0].wetted[1]=medail"}),
      ElementsAre("--set solid.body[0].wetted[1]=medail: the mesh has no surface \"medail\"; did you mean medial?"));
}

TEST(Setting, IsNamedWhenABlockOfItMissesAField) {
  EXPECT_THAT(
      complaints_about(good_scene, {"solid.body[0].material.mooney_rivlin={a10: 1 a1: 2}"}),
      ElementsAre(
          "--set solid.body[0].material.mooney_rivlin={a10: 1 a1: 2}: solid.body[0].material.mooney_rivlin.a1: is "
          "not a field of MooneyRivlin; its fields are a10, a01, bulk_modulus",
          "--set solid.body[0].material.mooney_rivlin={a10: 1 a1: 2}: solid.body[0].material.mooney_rivlin.a01: "
          "is missing; give it in Pa",
          "--set solid.body[0].material.mooney_rivlin={a10: 1 a1: 2}: "
          "solid.body[0].material.mooney_rivlin.bulk_modulus: is missing; give it in Pa"));
}

TEST(Setting, MissesTheEndOfABlock) {
  EXPECT_THAT(complaints_about(good_scene, {"flow.fluid={density: 1"}),
              ElementsAre("--set flow.fluid={density: 1: its { is not closed; add }"));
}

TEST(Setting, RefusesAWrongIndex) {
  EXPECT_THAT(complaints_about(good_scene, {"solid.body[2].name=a"}),
              ElementsAre("--set solid.body[2].name=a: body has 1 entry; body[1] appends"));
  EXPECT_THAT(complaints_about(good_scene, {"solid.body.name=a"}),
              ElementsAre("--set solid.body.name=a: body is a list; name one entry, body[0]; body[1] appends"));
  EXPECT_THAT(complaints_about(good_scene, {"time[0].step=1e-5"}),
              ElementsAre("--set time[0].step=1e-5: time is not a list; leave out [0]"));
}

TEST(Setting, RefusesAPathThatIsNone) {
  EXPECT_THAT(
      complaints_about(good_scene, {"time.step"}),
      ElementsAre(
          "--set time.step: a setting needs a value; write --set PATH=VALUE, for example --set time.step=1e-5"));
  EXPECT_THAT(complaints_about(good_scene, {"solid.body[x].name=a"}),
              ElementsAre("--set solid.body[x].name=a: \"body[x]\" is not a field of a path; write paths like "
                          "solid.body[0].material.density"));
  EXPECT_THAT(complaints_about(good_scene, {"time.step.size=1"}),
              ElementsAre("--set time.step.size=1: step is a single value; end the path there"));
}

TEST(Setting, IsReportedAfterTheSceneAndAllAtOnce) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: 0"), {"time.stp=1", "time.end=-1"}),
      ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: 0 is not above 0; give a value above 0 kg/m^3",
                  "--set time.stp=1: stp is not a field of Time; did you mean step?",
                  "--set time.end=-1: -1 is not above 0; give a value above 0 s"));
}

}  // namespace
}  // namespace couplet::scene
