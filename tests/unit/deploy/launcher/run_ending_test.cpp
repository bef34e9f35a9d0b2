// The exit code of a run follows from how its programs ended.

#include "deploy/launcher/run_ending.hpp"

#include <gmock/gmock.h>

#include <csignal>

namespace couplet::launcher {
namespace {

using testing::HasSubstr;

ProgramEnding ended(const std::string& program, int code, const std::string& last_words = {}) {
  return {program, {false, code}, program == "coupler" || program == "mpirun", false, last_words};
}

ProgramEnding killed(const std::string& program, int signal) {
  return {program, {true, signal}, program == "coupler", false, {}};
}

ProgramEnding asked(ProgramEnding ending) {
  ending.was_asked = true;
  return ending;
}

TEST(RunEnding, IsDoneWhenAllProgramsEndWell) {
  const Verdict verdict = judge({{ended("flow-server", 0), ended("coupler", 0), ended("solid-server", 0)}, "", false});
  EXPECT_EQ(verdict.exit_code, 0);
  EXPECT_EQ(verdict.sentence, "");
}

TEST(RunEnding, AKilledProgramExplainsWhatTheOthersComplainAbout) {
  const Verdict verdict = judge({{killed("solid-server", SIGKILL), ended("coupler", 4, "coupler: solid: lost"),
                                  asked(killed("flow-server", SIGTERM))},
                                 "",
                                 false});
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_THAT(verdict.sentence, HasSubstr("solid-server was killed (signal 9"));
  EXPECT_THAT(verdict.sentence, HasSubstr("--resume"));
}

TEST(RunEnding, ACrashIsABugAndNotALostPeer) {
  const Verdict verdict =
      judge({{killed("flow-server", SIGSEGV), ended("coupler", 4, "coupler: flow: lost")}, "", false});
  EXPECT_EQ(verdict.exit_code, 70);
  EXPECT_THAT(verdict.sentence, HasSubstr("flow-server crashed"));
}

TEST(RunEnding, AHostThatIsGoneIsALoss) {
  const Verdict verdict = judge({{ended("coupler", 4, "coupler: solid: lost"), ended("solid-server", 255)}, "", false});
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_TRUE(verdict.is_loss);
  EXPECT_THAT(verdict.sentence, HasSubstr("host of solid-server was lost"));
}

TEST(RunEnding, AProgramThatReportsItsFailureComesBeforeTheOneThatLostIt) {
  const Verdict verdict = judge({{ended("coupler", 4, "coupler: solid: the connection is gone"),
                                  ended("solid-server", 3, "solid-server: element 7 is inverted")},
                                 "",
                                 false});
  EXPECT_EQ(verdict.exit_code, 3);
  EXPECT_EQ(verdict.sentence, "solid-server: element 7 is inverted");
}

TEST(RunEnding, TheCouplersWordsComeFirstWhenAllReportTheSameFailure) {
  const Verdict verdict = judge({{ended("flow-server", 3, "flow-server: diverged"),
                                  ended("coupler", 3, "coupler: t = 0.01 s: diverged; use a smaller step")},
                                 "",
                                 false});
  EXPECT_EQ(verdict.sentence, "coupler: t = 0.01 s: diverged; use a smaller step");
}

TEST(RunEnding, AProgramOfTheUsersOwnIsNoBugOfCouplet) {
  ProgramEnding own = ended("solid \"./mine\"", 1, "ImportError: no module named numpy");
  own.is_own = true;
  const ProgramEnding lost = ended("coupler", 4, "coupler: solid: lost");
  Verdict verdict = judge({{own, lost}, "", false});
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_EQ(verdict.sentence, "solid \"./mine\" ended with code 1: ImportError: no module named numpy");
  own.ending = {false, 5};
  EXPECT_EQ(judge({{own, lost}, "", false}).exit_code, 5);
  own.ending = {true, SIGSEGV};
  verdict = judge({{own, lost}, "", false});
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_THAT(verdict.sentence, HasSubstr("solid \"./mine\" crashed (signal 11"));
}

TEST(RunEnding, AProgramThatDoesNotMoveIsLost) {
  const Verdict verdict =
      judge({{asked(killed("coupler", SIGKILL)), asked(killed("flow-server", SIGTERM))}, "coupler was stopped", false});
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_THAT(verdict.sentence, HasSubstr("coupler was stopped"));
}

TEST(RunEnding, StoppingOnRequestIsNotAFailure) {
  EXPECT_EQ(judge({{ended("coupler", 0), ended("flow-server", 0)}, "", true}).exit_code, 0);
  EXPECT_EQ(judge({{killed("solid-server", SIGTERM)}, "", true}).exit_code, 0);
}

TEST(RunEnding, AFailureWhileStoppingIsStillTold) {
  EXPECT_EQ(judge({{ended("coupler", 5, "coupler: disk full")}, "", true}).exit_code, 5);
}

TEST(RunEnding, AnMpiJobThatLostARankLostAParticipant) {
  const Verdict verdict = judge({{ended("mpirun", 137)}, "", false});
  EXPECT_EQ(verdict.exit_code, 4);
  EXPECT_THAT(verdict.sentence, HasSubstr("a program of the MPI job was killed (signal 9"));
}

TEST(RunEnding, ACodeThatNoProgramPromisesIsABug) {
  EXPECT_EQ(judge({{ended("solid-server", 1)}, "", false}).exit_code, 70);
}

}  // namespace
}  // namespace couplet::launcher
