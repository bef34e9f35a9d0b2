// The verb `attend` as the launcher uses it: a child process whose standard input says what to do.

#include "deploy/launcher/attendant.hpp"

#include <gtest/gtest.h>

#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "deploy/launcher/child_process.hpp"
#include "deploy/launcher/process_tree.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::launcher {
namespace {

using Clock = std::chrono::steady_clock;

ChildProcess attended(const std::string& script) {
  ProgramStart start{"sh", {COUPLET_LAUNCHER, "attend", "sh", "-c", script}, {}, {}, {}};
  start.is_attended = true;
  return {start, {}};
}

/// Its exit code, once it has ended; -1 when that takes too long.
int code_of(ChildProcess& process) {
  for (const auto deadline = Clock::now() + std::chrono::seconds(30); Clock::now() < deadline;) {
    process.look();
    if (!process.is_running()) return process.ending()->by_signal ? -2 : process.ending()->code;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return -1;
}

std::string first_line(ChildProcess& process) {
  for (const auto deadline = Clock::now() + std::chrono::seconds(30); Clock::now() < deadline;) {
    for (const OutputLine& line : process.read_output()) return line.text;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return "none";
}

bool lives(pid_t pid) {
  return !process_tree(pid).empty();
}

TEST(Attendant, HandsTheOutputAndTheExitCodeOn) {
  ChildProcess program = attended("echo here; exit 5");
  EXPECT_TRUE(program.is_attended());
  EXPECT_EQ(first_line(program), "here");
  EXPECT_EQ(code_of(program), 5);
}

TEST(Attendant, PassesSignalsOn) {
  ChildProcess program = attended("trap 'exit 7' TERM; echo here; while :; do sleep 0.01; done");
  EXPECT_EQ(first_line(program), "here");
  program.send_signal(SIGTERM);
  EXPECT_EQ(code_of(program), 7);
}

TEST(Attendant, ReachesAProgramByItsName) {
  ChildProcess program = attended("sleep 100 & echo here; wait; exit 6");
  EXPECT_EQ(first_line(program), "here");
  while (process_tree(program.pid()).size() < 3) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.signal_named("sleep", SIGTERM);
  EXPECT_EQ(code_of(program), 6);
}

TEST(Attendant, KillsAFrozenProgramAndAllThatItStarted) {
  ChildProcess program = attended("sleep 100 & echo $!; kill -STOP $$");
  const pid_t below = std::stoi(first_line(program));
  program.signal_tree(SIGKILL);
  EXPECT_EQ(code_of(program), 128 + SIGKILL);
  EXPECT_FALSE(lives(below));
}

TEST(Attendant, LetsNothingOutliveTheLauncher) {
  const store::TemporaryFolder folder;
  const std::string note = (folder / "pid").string();
  const std::string script = "trap : TERM; sleep 100 & echo $! > " + note + ".part; mv " + note + ".part " + note +
                             "; while :; do wait; sleep 0.01; done";
  FILE* words = popen((std::string(COUPLET_LAUNCHER) + " attend sh -c '" + script + "'").c_str(), "we");
  ASSERT_NE(words, nullptr);
  while (!std::filesystem::exists(note)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const pid_t below = std::stoi(store::text_of(note));
  EXPECT_TRUE(lives(below));
  const int status = pclose(words);  // its standard input ends: the connection is gone
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGKILL) << "it was deaf to the request to end";
  EXPECT_FALSE(lives(below));
}

}  // namespace
}  // namespace couplet::launcher
