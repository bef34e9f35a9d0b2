#include "proto/store/checkpoint_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::store {
namespace {

std::vector<std::int64_t> complete_steps(const std::filesystem::path& checkpoints) {
  std::vector<std::int64_t> steps;
  for (const auto& folder : complete_checkpoints(checkpoints)) steps.push_back(folder.step);
  return steps;
}

CheckpointFolder write_checkpoint(const std::filesystem::path& checkpoints, std::int64_t step,
                                  const std::string& state = "state") {
  const auto folder = make_checkpoint_folder(checkpoints, step);
  write_file(folder.participant_file("solid"), state);
  return complete_checkpoint(folder);
}

/// That no warning comes with it.
CheckpointFolder find(const std::filesystem::path& from) {
  return find_checkpoint(from, [](const std::string& warning) { ADD_FAILURE() << warning; });
}

TEST(CheckpointFolder, KeepsTheNewestTwoCompleteOnes) {
  const TemporaryFolder run;
  for (const int step : {5, 10, 100}) write_checkpoint(run / "checkpoint", step);
  EXPECT_THAT(complete_steps(run / "checkpoint"), testing::ElementsAre(10, 100));
  EXPECT_TRUE(std::filesystem::exists(run / "checkpoint" / "step-0000000100" / "solid.h5"));
  EXPECT_FALSE(std::filesystem::exists(run / "checkpoint" / "step-0000000005"));
}

TEST(CheckpointFolder, DoesNotCountOneThatACrashLeftIncomplete) {
  const TemporaryFolder run;
  for (const int step : {5, 10}) write_checkpoint(run / "checkpoint", step);
  const auto torn = make_checkpoint_folder(run / "checkpoint", 15);
  write_file(torn.participant_file("solid"), "sta");
  EXPECT_EQ(find(run.path()).step, 10);
  EXPECT_THROW(find(torn.path), report::FileError);
  write_checkpoint(run / "checkpoint", 20);
  EXPECT_THAT(complete_steps(run / "checkpoint"), testing::ElementsAre(10, 20));
  EXPECT_FALSE(std::filesystem::exists(torn.path)) << "it goes with the next complete one";
}

TEST(CheckpointFolder, ReplacesThatOfTheSameStep) {
  const TemporaryFolder run;
  write_checkpoint(run / "checkpoint", 5, "old");
  const CheckpointFolder folder = write_checkpoint(run / "checkpoint", 5, "newer");
  EXPECT_EQ(folder.path, run / "checkpoint" / "step-0000000005");
  EXPECT_EQ(std::filesystem::file_size(folder.participant_file("solid")), 5U);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(run / "checkpoint"), {}), 1);
}

TEST(CheckpointFolder, IsPassedOverWhenItIsDamaged) {
  struct Damage {
    const char* what;
    std::function<void(const std::filesystem::path&)> apply;
  };
  const std::vector<Damage> damages{
      {"solid.h5 was changed: its checksum does not agree", [](const auto& file) { write_file(file, "stote"); }},
      {"solid.h5 has 3 bytes instead of 5", [](const auto& file) { std::filesystem::resize_file(file, 3); }},
      {"solid.h5 is missing", [](const auto& file) { std::filesystem::remove(file); }},
  };
  for (const Damage& damage : damages) {
    const TemporaryFolder run;
    write_checkpoint(run / "checkpoint", 5);
    const CheckpointFolder newest = write_checkpoint(run / "checkpoint", 10);
    damage.apply(newest.participant_file("solid"));
    EXPECT_EQ(damage_of(newest), damage.what);
    std::vector<std::string> warnings;
    const auto warn = [&](const std::string& warning) { warnings.push_back(warning); };
    EXPECT_EQ(find_checkpoint(run.path(), warn).step, 5);
    EXPECT_THAT(warnings, testing::ElementsAre(testing::HasSubstr(damage.what)));
    EXPECT_THROW(find(newest.path), report::FileError) << "it was asked for by name";
    damage.apply(run / "checkpoint" / "step-0000000005" / "solid.h5");
    EXPECT_THROW(find_checkpoint(run.path(), warn), report::FileError);
  }
}

TEST(CheckpointFolder, IsFoundFromRunFolderCheckpointFolderAndStepFolder) {
  const TemporaryFolder run;
  for (const int step : {5, 10}) write_checkpoint(run / "checkpoint", step);
  EXPECT_EQ(find(run.path()).step, 10);
  EXPECT_EQ(find(run.path().string() + "/").step, 10);
  EXPECT_EQ(find(run / "checkpoint").step, 10);
  EXPECT_EQ(find(run / "checkpoint" / "step-0000000005").step, 5);
}

TEST(CheckpointFolder, SaysWhenThereIsNone) {
  const TemporaryFolder run;
  try {
    find(run.path());
    FAIL() << "was found";
  } catch (const report::FileError& error) {
    EXPECT_EQ(error.where(), run.path().string());
    EXPECT_EQ(error.sentence(), "there is no complete checkpoint here");
  }
}

TEST(CheckpointFolder, DropsLaterOnesOnceAResumedRunWritesItsOwn) {
  const TemporaryFolder run;
  for (const int step : {5, 10}) write_checkpoint(run / "checkpoint", step);
  write_checkpoint(run / "checkpoint", 7);  // resumed from 5
  EXPECT_THAT(complete_steps(run / "checkpoint"), testing::ElementsAre(5, 7));
}

TEST(CheckpointFolder, RefusesARunThatEndsBeforeIt) {
  const CheckpointFolder checkpoint{"run/checkpoint/step-0000000005", 5};
  EXPECT_NO_THROW(refuse_end_before_checkpoint(checkpoint, 0.5 + 1e-12, 0.5));  // round-off of summed steps
  try {
    refuse_end_before_checkpoint(checkpoint, 0.5, 0.4);
    FAIL() << "accepted";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "time.end: 0.4 s lies before the checkpoint run/checkpoint/step-0000000005, which is of t = 0.5 s; "
                 "give a later end, or resume from an earlier checkpoint");
  }
}

TEST(CheckpointFolder, LeavesOtherFilesAlone) {
  const TemporaryFolder run;
  std::filesystem::create_directories(run / "checkpoint" / "step-by-step");
  for (const int step : {5, 10, 15}) write_checkpoint(run / "checkpoint", step);
  EXPECT_TRUE(std::filesystem::exists(run / "checkpoint" / "step-by-step"));
}

}  // namespace
}  // namespace couplet::store
