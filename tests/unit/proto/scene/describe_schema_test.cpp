#include "proto/scene/describe_schema.hpp"

#include <gmock/gmock.h>

#include "proto/report/failure.hpp"

namespace couplet::scene {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Reference, TellsEverythingAboutAField) {
  const std::string text = describe_schema("SaintVenantKirchhoff");
  EXPECT_EQ(text,
            "SaintVenantKirchhoff  (solid.body.material.saint_venant_kirchhoff)\n"
            "S = lambda tr(E) I + 2 mu E. Softens in strong compression.\n"
            "\n"
            "  young_modulus: number [Pa], above 0, must be given\n"
            "      E\n"
            "  poisson_ratio: number, above -1 and below 0.5, must be given\n"
            "      nu\n");
}

TEST(Reference, StartsWithTheSceneAndReachesEveryMessageOnce) {
  const std::string text = describe_schema("");
  EXPECT_EQ(text.find("Scene\n"), 0U);
  for (const std::string page :
       {"\nGlottis  (flow.glottis)\n", "\nMooneyRivlin  (solid.body.material.mooney_rivlin)\n",
        "\nTimeTable.Row  (flow.glottis.subglottal_pressure.row)\n", "\nCheckpoints  (output.checkpoints)\n"}) {
    const std::size_t place = text.find(page);
    EXPECT_NE(place, std::string::npos) << page;
    EXPECT_EQ(text.find(page, place + 1), std::string::npos) << page;
  }
}

TEST(Reference, ShowsDefaultsUnitsAndChoices) {
  const std::string text = describe_schema("Glottis");
  EXPECT_THAT(text, HasSubstr("  smallest_gap: number [m], above 0, default 0.0002\n"));
  EXPECT_THAT(text, HasSubstr("  stations: whole number, at least 20 and at most 100000, default 140\n"));
  EXPECT_THAT(text, HasSubstr("  model: B1, B2, M1 or M2, must be given\n"));
  EXPECT_THAT(text, HasSubstr("        B1: Bernoulli, separation at the smallest area\n"));
  EXPECT_THAT(text, HasSubstr("  unsteady: true or false, default true\n"));
  EXPECT_THAT(text, HasSubstr("  height: formula in x, y, z, t, pi, must be given\n"));
}

TEST(Reference, PutsTheMembersOfAChoiceTogether) {
  EXPECT_THAT(describe_schema("Material"),
              HasSubstr("  one of these (law):\n    saint_venant_kirchhoff: SaintVenantKirchhoff\n"));
  EXPECT_THAT(describe_schema("Coupling"),
              HasSubstr("  at most one of these (acceleration):\n    constant: ConstantRelaxation\n"));
}

TEST(Reference, FindsAMessageByAnyOfItsNames) {
  const std::string text = describe_schema("Glottis");
  for (const std::string name : {"couplet.v1.Glottis", "glottis", "flow.glottis"})
    EXPECT_EQ(describe_schema(name), text) << name;
}

TEST(Reference, FindsFieldsByNameAndPath) {
  EXPECT_EQ(describe_schema("midplane").find("flow.glottis.midplane: number [m]\n"), 0U);
  EXPECT_EQ(describe_schema("solid.body[0].material.density"),
            "solid.body.material.density: number [kg/m^3], above 0, must be given\n    density at rest\n");
  EXPECT_THAT(describe_schema("density"), HasSubstr("flow.fluid.density"));
}

TEST(Reference, KeepsWhatTwoProgramsSayToEachOtherOut) {
  EXPECT_THAT(describe_schema(""), Not(HasSubstr("AcceptStep")));
}

TEST(Reference, SuggestsTheNearestNameForAnUnknownOne) {
  try {
    describe_schema("Glotis");
    FAIL() << "an unknown message was described";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(), "the scene language has no message or field \"Glotis\"; did you mean Glottis?");
  }
  try {
    describe_schema("Banana");
    FAIL() << "an unknown message was described";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "the scene language has no message or field \"Banana\"; couplet describe lists all of them");
  }
}

}  // namespace
}  // namespace couplet::scene
