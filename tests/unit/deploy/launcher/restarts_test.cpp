#include "deploy/launcher/restarts.hpp"

#include <gmock/gmock.h>

#include "proto/store/checkpoint_folder.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::launcher {
namespace {

using testing::HasSubstr;

const Verdict loss{4, "solid-server was killed", true}, failure{3, "diverged"}, done{};

void write_checkpoint(const std::filesystem::path& run, std::int64_t step) {
  const auto folder = store::make_checkpoint_folder(run / "checkpoint", step);
  store::write_file(folder.participant_file("solid"), "state");
  store::complete_checkpoint(folder);
}

RunOptions options(int n_restarts) {
  RunOptions run;
  run.restarts = n_restarts;
  return run;
}

TEST(Restarts, FollowTheLossOfAProgramAndNothingElse) {
  const store::TemporaryFolder run;
  EXPECT_TRUE(Restarts(options(3), {run.path()}).after(loss, false));
  EXPECT_FALSE(Restarts(options(3), {run.path()}).after(failure, false));
  EXPECT_FALSE(Restarts(options(3), {run.path()}).after(done, false));
  EXPECT_FALSE(Restarts(options(3), {run.path()}).after(loss, true)) << "the user has asked it to stop";
  EXPECT_FALSE(Restarts(options(0), {run.path()}).after(loss, false));
}

TEST(Restarts, GoOnFromTheNewestCheckpointThatIsWhole) {
  const store::TemporaryFolder run;
  Restarts restarts(options(3), {run.path()});
  EXPECT_TRUE(restarts.after(loss, false)->resume.empty()) << "there is none yet";
  EXPECT_THAT(restarts.from_where(), HasSubstr("beginning"));
  write_checkpoint(run.path(), 5);
  write_checkpoint(run.path(), 10);
  EXPECT_EQ(restarts.after(loss, false)->resume, run.path());
  EXPECT_THAT(restarts.from_where(), HasSubstr("step 10"));
  store::write_file(run / "checkpoint" / "step-0000000010" / "solid.h5", "stote");
  EXPECT_THAT(restarts.from_where(), HasSubstr("step 5"));
}

TEST(Restarts, EndWhenTheyLeadNowhere) {
  const store::TemporaryFolder run;
  Restarts restarts(options(2), {run.path()});
  EXPECT_TRUE(restarts.after(loss, false));
  EXPECT_TRUE(restarts.after(loss, false));
  write_checkpoint(run.path(), 5);  // it went on for a while
  EXPECT_TRUE(restarts.after(loss, false));
  EXPECT_TRUE(restarts.after(loss, false));
  EXPECT_TRUE(restarts.after(loss, false));
  EXPECT_FALSE(restarts.after(loss, false));
  EXPECT_EQ(restarts.n_restarts(), 5);
  const Verdict verdict = restarts.settle(loss);
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_THAT(verdict.sentence, HasSubstr("lost 3 times in a row before it came to its next checkpoint"));
  EXPECT_THAT(verdict.sentence, HasSubstr("solid-server was killed"));
}

TEST(Restarts, KeepTheNumberOfStepsThatWasAskedFor) {
  const store::TemporaryFolder run;
  const std::filesystem::path before = run / "before";
  write_checkpoint(before, 100);
  RunOptions wanted = options(3);
  wanted.steps = 50;
  wanted.resume = before;
  Restarts restarts(wanted, {run.path()});
  EXPECT_EQ(restarts.after(loss, false)->steps, 50);
  EXPECT_EQ(restarts.after(loss, false)->resume, before);
  write_checkpoint(run.path(), 120);
  EXPECT_EQ(restarts.after(loss, false)->steps, 30);
}

}  // namespace
}  // namespace couplet::launcher
