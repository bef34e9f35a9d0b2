// The rules that the schema declares on the fields.

#include "proto/scene/check_scene.hpp"

#include <gmock/gmock.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <every_rule.pb.h>
#include "proto/scene/message_parser.hpp"
#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class EveryRule : public testing::Test {
 protected:
  EveryRule() : folder_(std::filesystem::temp_directory_path() / ("couplet-rules-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_ / "tables");
    std::ofstream(folder_ / "tables" / "force.csv") << "1\n";
  }
  ~EveryRule() override { std::filesystem::remove_all(folder_); }

  std::vector<std::string> complaints_about_rules(const std::string& text) const {
    ComplaintList complaints("rules.txtpb");
    test::EveryRule message;
    FieldTree tree;
    const bool braces_match = MessageParser(text, "", complaints).parse_all(message, tree);
    Review review(tree, braces_match, complaints);
    check_fields(message, folder_, review);
    std::vector<std::string> lines;
    for (const Complaint& complaint : complaints.in_order()) lines.push_back(complaint.text());
    return lines;
  }

  const std::string enough_ = "name: \"a\" constant: 1 level: [1, 2] ";
  std::filesystem::path folder_;
};

TEST_F(EveryRule, IsKeptByAMessageWithoutFault) {
  EXPECT_THAT(complaints_about_rules(enough_ +
                                     "table: \"tables/force.csv\" factor: [1, 10] flag: [true, false] formula: \"x\""),
              IsEmpty());
}

TEST_F(EveryRule, FindsFilesFromTheFolderOfTheScene) {
  EXPECT_THAT(
      complaints_about_rules(enough_ + "\ntable: \"tables/force.txt\""),
      ElementsAre(
          "rules.txtpb:2:1: table: the file \"tables/force.txt\" does not exist; give a file, its path starting "
          "from the folder of the scene"));
  EXPECT_THAT(
      complaints_about_rules(enough_ + "\ntable: \"tables\""),
      ElementsAre("rules.txtpb:2:1: table: the file \"tables\" is a folder; give a file, its path starting from the "
                  "folder of the scene"));
}

TEST_F(EveryRule, ChecksEveryEntryOfAListOfFiles) {
  EXPECT_THAT(
      complaints_about_rules(enough_ + "picture: [\"tables/force.csv\", \"b.png\"]"),
      ElementsAre(
          "rules.txtpb:1:67: picture[1]: the file \"b.png\" does not exist; give a file, its path starting from "
          "the folder of the scene"));
}

TEST_F(EveryRule, ChecksEveryEntryOfAListOfNumbers) {
  EXPECT_THAT(complaints_about_rules(enough_ + "\nfactor: [1, 0, 11, nan, -inf]"),
              ElementsAre("rules.txtpb:2:13: factor[1]: 0 is not above 0; give a value above 0 and at most 10 Pa",
                          "rules.txtpb:2:16: factor[2]: 11 is not at most 10; give a value above 0 and at most 10 Pa",
                          "rules.txtpb:2:20: factor[3]: nan is not a finite number; give it in Pa",
                          "rules.txtpb:2:25: factor[4]: -inf is not a finite number; give it in Pa"));
}

TEST_F(EveryRule, ChecksEveryEntryOfAListOfFormulas) {
  EXPECT_THAT(
      complaints_about_rules(enough_ + "\nformula: [\"x\", \"x+\"]"),
      ElementsAre("rules.txtpb:2:16: formula[1]: the formula \"x+\" cannot be read at character 3: it ends too early; "
                  "write it with x, y, z, t, pi, + - * / ^ and functions such as sin, exp, sqrt, abs"));
}

TEST_F(EveryRule, CountsTheEntriesOfAList) {
  EXPECT_THAT(complaints_about_rules("name: \"a\" constant: 1 level: 3"),
              ElementsAre("rules.txtpb:1:1: level: has too few entries; give at least 2"));
  EXPECT_THAT(complaints_about_rules("name: \"a\" constant: 1"),
              ElementsAre("rules.txtpb:1:1: level: is missing; give a whole number"));
  const std::string picture = "picture: \"tables/force.csv\" ";
  EXPECT_THAT(
      complaints_about_rules(enough_ + '\n' + picture + picture + picture),
      ElementsAre("rules.txtpb:2:57: picture[2]: is one entry too many; at most 2 may be given, delete the others"));
}

TEST_F(EveryRule, WantsOneMemberOfAChoice) {
  EXPECT_THAT(complaints_about_rules("name: \"a\" level: [1, 2]"),
              ElementsAre("rules.txtpb:1:1: has no law; give linear or constant"));
}

TEST_F(EveryRule, HoldsInsideABlockToo) {
  EXPECT_THAT(complaints_about_rules(enough_ + "\n inner { level: [1, 5] }"),
              ElementsAre("rules.txtpb:2:2: inner.name: is missing; give it in quotes: name of the table",
                          "rules.txtpb:2:2: inner: has no law; give linear or constant",
                          "rules.txtpb:2:21: inner.level[1]: 5 is not below 5; give a value at least 1 and below 5"));
}

TEST_F(EveryRule, CountsNothingAsMissingThatCouldNotBeRead) {
  EXPECT_THAT(complaints_about_rules("name: 3 constant: a level: [a, 2]"),
              ElementsAre("rules.txtpb:1:1: name: 3 is not in quotes; write \"3\"",
                          "rules.txtpb:1:9: constant: a is not a number; give a number",
                          "rules.txtpb:1:29: level[0]: a is not a number; give a whole number"));
}

TEST(SceneCheck, NamesTheUnitOfAMissingNumber) {
  EXPECT_THAT(complaints_about(with("density: 1040\n", "\n")),
              ElementsAre("scene.txtpb:22:5: solid.body[0].material.density: is missing; give it in kg/m^3"));
}

TEST(SceneCheck, NamesTheChoicesOfAMissingOne) {
  EXPECT_THAT(complaints_about(with("model: M2", "")),
              ElementsAre("scene.txtpb:6:3: flow.glottis.model: is missing; choose B1, B2, M1 or M2"));
}

TEST(SceneCheck, MissesABlockButNotWhatIsInside) {
  EXPECT_THAT(complaints_about(with("fluid { density: 1.13  viscosity: 1.8e-5 }", "")),
              ElementsAre("scene.txtpb:4:1: flow.fluid: is missing; give fluid { ... }: the fluid"));
}

TEST(SceneCheck, MissesFieldsOfTheSceneItselfAtItsStart) {
  EXPECT_THAT(
      complaints_about(""),
      ElementsAre("scene.txtpb:1:1: title: is missing; give it in quotes: one line that says what is computed",
                  "scene.txtpb:1:1: time: is missing; give time { ... }: span and step",
                  "scene.txtpb:1:1: neither flow nor solid is given; give flow { ... }, solid { ... } or both"));
}

TEST(SceneCheck, RefusesAnEmptyTitle) {
  EXPECT_THAT(complaints_about(with("\"a fold in its own flow\"", "\"\"")),
              ElementsAre("scene.txtpb:1:1: title: is empty; give it in quotes: one line that says what is computed"));
}

TEST(SceneCheck, RefusesNamesThatCannotBeColumns) {
  EXPECT_THAT(
      complaints_about(with("name: \"frequency\"", "name: \"main line, Hz\"")),
      ElementsAre("scene.txtpb:39:14: output.quantity[0].name: \"main line, Hz\" is no name; use letters, digits, _ - "
                  "and . only"));
}

TEST(SceneCheck, RefusesTextThatIsNoTextOfOneLine) {
  EXPECT_THAT(
      complaints_about(with("\"a fold in its own flow\"", "\"a\\nb\"")),
      ElementsAre("scene.txtpb:1:1: title: holds a line break, a tab or another invisible character; write one line of "
                  "text"));
  EXPECT_THAT(complaints_about(with("\"a fold in its own flow\"", "\"K\xF6rper\"")),
              ElementsAre("scene.txtpb:1:1: title: is not text in UTF-8; save the scene in UTF-8"));
  EXPECT_THAT(complaints_about(with("\"a fold in its own flow\"", "\"K\xC3\xB6rper\"")), IsEmpty());
}

TEST(SceneCheck, NamesLineOfNegativeDensity) {
  EXPECT_THAT(
      complaints_about(with("density: 1040", "density: -1")),
      ElementsAre("scene.txtpb:23:7: solid.body[0].material.density: -1 is not above 0; give a value above 0 kg/m^3"));
}

TEST(SceneCheck, GivesTheRemedyThatTheSchemaNames) {
  EXPECT_THAT(
      complaints_about(with("poisson_ratio: 0.475", "poisson_ratio: 0.5")),
      ElementsAre(
          "scene.txtpb:24:53: solid.body[0].material.saint_venant_kirchhoff.poisson_ratio: 0.5 is not below 0.5; "
          "give a value between -1 and 0.5; for nearly incompressible tissue use mooney_rivlin"));
}

TEST(SceneCheck, RefusesNumbersThatAreNotFiniteEvenWithoutLimits) {
  for (const std::string word : {"nan", "-nan", "inf", "-infinity", "NaN"}) {
    SCOPED_TRACE(word);
    const std::vector<std::string> complaints = complaints_about(with("midplane: 0.0102", "midplane: " + word));
    ASSERT_EQ(complaints.size(), 1U);
    EXPECT_THAT(complaints[0],
                testing::MatchesRegex("scene.txtpb:14:5: flow.glottis.midplane: (nan|inf|-inf) is not a finite "
                                      "number; give it in m"));
  }
}

TEST(SceneCheck, WantsALawForTheMaterial) {
  EXPECT_THAT(
      complaints_about(with("saint_venant_kirchhoff { young_modulus: 15e3  poisson_ratio: 0.475 }", "")),
      ElementsAre("scene.txtpb:22:5: solid.body[0].material: has no law; give saint_venant_kirchhoff, mooney_rivlin, "
                  "neo_hookean, holzapfel_gasser_ogden or may_newman"));
}

}  // namespace
}  // namespace couplet::scene
