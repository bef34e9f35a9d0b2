// Programs that are killed, frozen or deaf never outlive the run. Shell scripts stand in for the three programs.

#include "deploy/launcher/supervisor.hpp"

#include <gmock/gmock.h>
#include <signal.h>

#include <fstream>
#include <sstream>
#include <thread>

#include "deploy/launcher/process_tree.hpp"

namespace couplet::launcher {
namespace {

using testing::HasSubstr;

class SupervisorTest : public testing::Test {
 protected:
  static ProgramStart script(const std::string& name, const std::string& text) {
    return {name, {"/bin/sh", "-c", text}, {}, {}, {}};
  }

  std::string log_text() const {
    std::ifstream file(log_);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

  const std::filesystem::path log_ = std::filesystem::path(testing::TempDir()) / "supervisor_test_log.txt";
  RunConsole console_{log_, true};
  using Seconds = std::chrono::duration<double>;
  // Long enough for a busy machine, short enough for a test: each step of the escalation waits at least for its own
  // time.
  Patience patience_{Seconds(5), Seconds(0.6), Seconds(0.3), Seconds(1.2)};
};

TEST_F(SupervisorTest, HearsWhereAServerListens) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("flow-server", "echo listening ipc://@here"));
  EXPECT_EQ(supervisor.wait_for_address("flow-server"), "ipc://@here");
  EXPECT_EQ(judge(supervisor.run_to_end()).exit_code, 0);
}

TEST_F(SupervisorTest, AServerThatEndsBeforeItListensEndsTheRunWithItsCode) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("flow-server", "echo 'flow-server: no such scene' >&2; exit 2"));
  supervisor.start_server(script("solid-server", "exec sleep 60"));
  EXPECT_EQ(supervisor.wait_for_address("flow-server"), std::nullopt);
  const Verdict verdict = judge(supervisor.end_all());
  EXPECT_EQ(verdict.exit_code, 2);
  EXPECT_EQ(verdict.sentence, "flow-server: no such scene");
}

TEST_F(SupervisorTest, AServerThatEndsWellButNeverListensIsLost) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("flow-server", "exec sleep 60"));
  supervisor.start_server(script("solid \"true\"", "exit 0"));
  EXPECT_EQ(supervisor.wait_for_address("flow-server"), std::nullopt);
  const Verdict verdict = judge(supervisor.end_all());
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_THAT(verdict.sentence, HasSubstr("solid \"true\" ended before it said where it listens"));
}

TEST_F(SupervisorTest, TheLastWordsOfAProgramOfTheUsersOwnAreItsLastLineOfErrors) {
  Supervisor supervisor(console_, patience_);
  ProgramStart own = script("solid \"x\"", "echo first >&2; echo why >&2; echo listening; exit 1");
  own.is_own = true;
  supervisor.start_server(own);
  const RunEnding ending = supervisor.run_to_end();
  ASSERT_EQ(ending.endings.size(), 1u);
  EXPECT_EQ(ending.endings[0].last_words, "why");
  EXPECT_EQ(judge(ending).exit_code, 4);
}

TEST_F(SupervisorTest, EndsServersThatOutliveTheLeader) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("flow-server", "exec sleep 60"));
  supervisor.start_leader(script("coupler", "exit 0"));
  EXPECT_EQ(judge(supervisor.run_to_end()).exit_code, 0);
}

TEST_F(SupervisorTest, KillsAProgramThatIsDeafToTheRequestToEnd) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("flow-server", "trap '' TERM; while true; do sleep 0.05; done"));
  supervisor.start_leader(script("coupler", "kill -KILL $$"));
  const RunEnding ending = supervisor.run_to_end();
  ASSERT_EQ(ending.endings.size(), 2u);
  EXPECT_EQ(ending.endings[1].ending.code, SIGKILL);
  EXPECT_EQ(judge(ending).exit_code, 4);
}

TEST_F(SupervisorTest, GivesUpAProgramThatWasStoppedByASignal) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("solid-server", "kill -STOP $$; exec sleep 60"));
  supervisor.start_leader(script("coupler", "exec sleep 60"));
  const RunEnding ending = supervisor.run_to_end();
  EXPECT_THAT(ending.stuck, HasSubstr("was stopped by a signal"));
  EXPECT_EQ(judge(ending).exit_code, 4);
}

TEST_F(SupervisorTest, LeavesNothingThatAProgramHasStarted) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_leader(script("mpirun", "sleep 60 & exit 0"));
  EXPECT_EQ(judge(supervisor.run_to_end()).exit_code, 0);
  EXPECT_EQ(process_tree(getpid()).size(), 1u);  // this test itself
}

TEST_F(SupervisorTest, PassesOnTheWishToStopToTheLeaderOnly) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("solid-server", "trap 'exit 9' TERM; sleep 0.7"));
  supervisor.start_leader(script("coupler", "trap 'echo heard; exit 0' TERM; while true; do sleep 0.05; done"));
  std::thread user([pid = getpid()] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(pid, SIGTERM);
  });
  const RunEnding ending = supervisor.run_to_end();
  user.join();
  EXPECT_TRUE(ending.stop_requested);
  EXPECT_EQ(judge(ending).exit_code, 0);
  EXPECT_THAT(log_text(), HasSubstr("coupler heard"));
}

TEST_F(SupervisorTest, WritesToTheLogWhatEveryProgramSays) {
  Supervisor supervisor(console_, patience_);
  supervisor.start_server(script("flow-server", "echo mesh is fine"));
  supervisor.start_leader(script("coupler", "echo hello >&2"));
  supervisor.run_to_end();
  EXPECT_THAT(log_text(), HasSubstr(" flow-server mesh is fine\n"));
  EXPECT_THAT(log_text(), HasSubstr(" coupler hello\n"));
}

TEST(ProcessTree, FindsWhatAProcessHasStarted) {
  const ChildProcess process({"sh", {"/bin/sh", "-c", "sleep 60 & wait"}, {}, {}, {}}, {});
  std::vector<ProcessState> tree;
  for (int i = 0; i < 500 && tree.size() < 2; ++i) {  // the shell needs a moment; 5 s are far more than it takes
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    tree = process_tree(process.pid());
  }
  ASSERT_EQ(tree.size(), 2u);
  EXPECT_EQ(tree[0].pid, process.pid());
  EXPECT_EQ(tree[1].name, "sleep");
  EXPECT_FALSE(tree[1].is_frozen);
  kill(tree[1].pid, SIGKILL);
}

}  // namespace
}  // namespace couplet::launcher
