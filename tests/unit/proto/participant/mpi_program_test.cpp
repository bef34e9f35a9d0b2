// Whole MPI jobs: a coupler and servers started by one mpirun, and how they end together.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/proto/participant/child_program.hpp"

namespace couplet::participant {

namespace {

using testing::HasSubstr;

using Command = std::vector<std::string>;

const Command solid = {"-n", "1", COUPLET_SPRING_SERVER, "serve", "--transport", "mpi", "--heartbeat", "0.8"};

ChildProgram job(const std::string& part, const std::vector<Command>& servers) {
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  Command command = {COUPLET_MPIRUN, "--oversubscribe", "--bind-to", "none", "-n", "1", COUPLET_SPRING_COUPLER, part};
  for (const Command& server : servers) {
    command.push_back(":");
    command.insert(command.end(), server.begin(), server.end());
  }
  return ChildProgram(std::move(command));
}

TEST(MpiProgram, ASessionEndsWellForEverybody) {
  auto all = job("finish", {solid});
  EXPECT_EQ(all.exit_code(), 0) << all.errors();
  EXPECT_THAT(all.output(), HasSubstr("closed after 1.5 s"));
  EXPECT_THAT(all.errors(), HasSubstr("results are complete"));
}

// The step takes longer than the heartbeat: a busy server is not a lost one.
TEST(MpiProgram, AServerMayComputeForLongerThanTheHeartbeat) {
  auto all = job("slow", {solid});
  EXPECT_EQ(all.exit_code(), 0) << all.errors();
}

TEST(MpiProgram, ANumericalFailureIsTheExitCodeOfTheJob) {
  auto all = job("tear", {solid});
  EXPECT_EQ(all.exit_code(), 3) << all.errors();
  EXPECT_THAT(all.errors(), HasSubstr("results are complete"));
  EXPECT_THAT(all.errors(), HasSubstr("coupler: spring 1: is torn; pull less"));
  EXPECT_THAT(all.errors(), HasSubstr("solid-server: spring 1: is torn; pull less"));
}

TEST(MpiProgram, ALostCouplerEndsTheJobWithTheCodeOfALostPeer) {
  auto all = job("vanish", {solid});
  EXPECT_EQ(all.exit_code(), 4) << all.errors();
  EXPECT_THAT(all.errors(), HasSubstr("coupler: coupler: has lost its senses"));
}

TEST(MpiProgram, AFrozenCouplerIsNoticedByAnIdleServer) {
  auto all = job("freeze", {solid});
  EXPECT_EQ(all.exit_code(), 4) << all.errors();
  EXPECT_THAT(all.errors(), HasSubstr("results are complete"));
  EXPECT_THAT(all.errors(), HasSubstr("solid-server: mpi, coupler: the program at the other end gave no sign of life"));
}

TEST(MpiProgram, AJobWithoutServersIsRefused) {
  auto all = job("alone", {});
  EXPECT_EQ(all.exit_code(), 2) << all.errors();
  EXPECT_THAT(all.errors(), HasSubstr("MPI job: has 1 couplers among 1 processes"));
}

TEST(MpiProgram, AServerThatCannotStartEndsTheJob) {
  Command wrong = solid;
  wrong.insert(wrong.end(), {"/nowhere/scene.txtpb"});
  auto all = job("finish", {wrong});
  EXPECT_EQ(all.exit_code(), 5) << all.errors();
  EXPECT_THAT(all.errors(), HasSubstr("/nowhere/scene.txtpb"));
}

}  // namespace

}  // namespace couplet::participant
