// What a scene names is launched, and nothing else.

#include "deploy/launcher/launch_plan.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "deploy/launcher/flow_ranks.hpp"

#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::SizeIs;

using Words = std::vector<std::string>;

class LaunchPlanTest : public testing::Test {
 protected:
  void SetUp() override {
    programs_ = std::filesystem::path(testing::TempDir()) / "launch_plan_programs";
    std::filesystem::create_directories(programs_);
    for (const char* name : {"coupler", "flow-server", "solid-server"}) std::ofstream(programs_ / name) << "program";
    options_.scene = "scene.txtpb";
  }

  LaunchPlan plan() const {
    return plan_launch(scene_, options_, {programs_, "/sources", "python3"}, "/run", "/sockets", hosts_);
  }

  std::filesystem::path programs_;
  v1::Scene scene_;
  RunOptions options_;
  std::optional<v1::Hosts> hosts_;
};

TEST_F(LaunchPlanTest, CoupledSceneNeedsTwoServersAndTheCoupler) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  const LaunchPlan found = plan();
  ASSERT_THAT(found.servers, SizeIs(2));
  EXPECT_EQ(found.servers[0].name, "flow-server");
  EXPECT_EQ(found.servers[0].address_option, "--flow");
  EXPECT_EQ(found.servers[1].name, "solid-server");
  EXPECT_EQ(found.servers[1].address_option, "--solid");
  EXPECT_EQ(found.leader.name, "coupler");
}

TEST_F(LaunchPlanTest, SolidOnlySceneStartsTheSolidServerAlone) {
  scene_.mutable_solid();
  options_.solid_threads = 3;
  const LaunchPlan found = plan();
  EXPECT_THAT(found.servers, IsEmpty());
  EXPECT_THAT(found.leader.command, ElementsAre((programs_ / "solid-server").string(), "run", "scene.txtpb", "--out",
                                                "/run", "--threads", "3"));
}

TEST_F(LaunchPlanTest, FlowOnlySceneStartsTheFlowServerAlone) {
  scene_.mutable_flow();
  const LaunchPlan found = plan();
  EXPECT_THAT(found.servers, IsEmpty());
  EXPECT_THAT(found.leader.command,
              ElementsAre((programs_ / "flow-server").string(), "run", "scene.txtpb", "--out", "/run"));
}

TEST_F(LaunchPlanTest, FlowOnSeveralRanksIsOneJobThatFlowServerEndsInGoodOrder) {
  scene_.mutable_flow()->mutable_navier_stokes();
  options_.flow_ranks = 3;
  const LaunchPlan found = plan();
  EXPECT_THAT(found.servers, IsEmpty());
  EXPECT_EQ(found.leader.name, "mpirun");
  EXPECT_EQ(found.leader.owner_of_time, "flow-server");
  EXPECT_THAT(found.leader.command,
              ElementsAre("mpirun", "--oversubscribe", "--bind-to", "none", "--tag-output", "-n", "3",
                          (programs_ / "flow-server").string(), "run", "scene.txtpb", "--out", "/run"));
  options_.flow_ranks = 1;
  EXPECT_EQ(plan().leader.name, "flow-server");
}

TEST_F(LaunchPlanTest, CoupledFlowOnSeveralRanksIsAJobThatIsReachedByItsSocket) {
  scene_.mutable_flow()->mutable_navier_stokes();
  scene_.mutable_solid();
  options_.flow_ranks = 2;
  const LaunchPlan found = plan();
  ASSERT_THAT(found.servers, SizeIs(2));
  EXPECT_EQ(found.servers[0].name, "mpirun");
  EXPECT_EQ(found.servers[0].address_option, "--flow");
  EXPECT_THAT(found.servers[0].command, Contains("-n"));
  EXPECT_THAT(found.servers[0].command, Contains("2"));
  EXPECT_THAT(found.servers[0].command, Contains("--listen"));
  EXPECT_EQ(found.servers[1].name, "solid-server");
  EXPECT_EQ(found.leader.name, "coupler");
}

TEST_F(LaunchPlanTest, GlottalFlowOnSeveralRanksIsRefused) {
  scene_.mutable_flow()->mutable_glottis();
  options_.flow_ranks = 2;
  EXPECT_THROW(plan(), report::SceneError);
}

TEST_F(LaunchPlanTest, FlowRanksAreThoseOfTheBlocksThenOfTheUserThenOfTheCells) {
  const Installation installation{programs_, "/sources", "python3"};
  v1::Decomposition* blocks = scene_.mutable_flow()->mutable_navier_stokes()->mutable_decomposition();
  blocks->set_x(2);
  blocks->set_z(3);
  EXPECT_EQ(choose_flow_ranks(scene_, options_, installation), 6);
  options_.flow_ranks = 4;
  try {
    choose_flow_ranks(scene_, options_, installation);
    FAIL() << "four ranks for six blocks were not refused";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "--flow-ranks: 4 is not the number of blocks in the scene, 6; leave out --flow-ranks, or "
                 "flow.navier_stokes.decomposition");
  }
  scene_.mutable_flow()->mutable_navier_stokes()->clear_decomposition();
  EXPECT_EQ(choose_flow_ranks(scene_, options_, installation), 4);
  EXPECT_EQ(ranks_for_cells(1000, 8), 1);
  EXPECT_EQ(ranks_for_cells(1e5, 8), 4);
  EXPECT_EQ(ranks_for_cells(1e8, 47), 36);
  EXPECT_EQ(ranks_for_cells(1e8, 8), 8);
  EXPECT_EQ(ranks_for_cells(1e8, 0), 1);
  v1::Scene glottis;
  glottis.mutable_flow()->mutable_glottis();
  EXPECT_EQ(choose_flow_ranks(glottis, {}, installation), 1);
}

TEST_F(LaunchPlanTest, AProgramOfTheUsersOwnTakesThePlaceOfAServer) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  options_.settings = {"time.step=1e-5"};
  options_.own_solid = "env 'two words' --stiffness 5";
  const LaunchPlan found = plan();
  ASSERT_THAT(found.servers, SizeIs(2));
  EXPECT_EQ(found.servers[0].name, "flow-server");
  EXPECT_FALSE(found.servers[0].is_own);
  EXPECT_EQ(found.servers[1].name, "solid \"env 'two words' --stiffness 5\"");
  EXPECT_TRUE(found.servers[1].is_own);
  EXPECT_EQ(found.servers[1].address_option, "--solid");
  EXPECT_THAT(found.servers[1].command, ElementsAre("env", "two words", "--stiffness", "5", "serve", "--listen",
                                                    "ipc:///sockets/solid", "scene.txtpb"));
  EXPECT_THAT(found.servers[1].environment.at("PYTHONPATH"), HasSubstr("/sources/deploy/participant"));
  scene_.mutable_coupling()->set_listen("tcp://10.0.0.5:*");
  scene_.mutable_coupling()->set_heartbeat_deadline(3);
  options_.keys = "/my/keys";
  EXPECT_THAT(plan().servers[1].command,
              ElementsAre("env", "two words", "--stiffness", "5", "serve", "--listen", "tcp://10.0.0.5:*",
                          "--heartbeat", "3", "--key", "/my/keys/solid-server.key", "scene.txtpb"));
}

TEST_F(LaunchPlanTest, AProgramOfTheUsersOwnNeedsACoupledSceneAndSockets) {
  const auto refusal = [this] {
    try {
      plan();
    } catch (const report::SceneError& error) {
      return std::string(error.what());
    }
    return std::string("not refused");
  };
  options_.own_flow = "env";
  scene_.mutable_flow();
  EXPECT_THAT(refusal(), HasSubstr("--flow: the scene has no solid"));
  scene_.mutable_solid();
  scene_.mutable_coupling()->set_transport(v1::MPI);
  EXPECT_THAT(refusal(), HasSubstr("--flow: a program of your own is reached over ZeroMQ"));
  options_.transport = "zmq";
  options_.flow_ranks = 2;
  EXPECT_THAT(refusal(), HasSubstr("--flow-ranks: is for flow-server"));
  options_.flow_ranks = 0;
  EXPECT_EQ(refusal(), "not refused");
  options_.own_flow = "no_such_program_anywhere";
  EXPECT_THAT(refusal(), HasSubstr("there is no program no_such_program_anywhere"));
  options_.own_flow = "env | env";
  EXPECT_THAT(refusal(), HasSubstr("is not a program with its options"));
  options_.own_flow = "env $COUPLET_NO_SUCH_VARIABLE";
  EXPECT_THAT(refusal(), HasSubstr("has no value"));
}

TEST_F(LaunchPlanTest, SceneWithNeitherFlowNorSolidIsRefused) {
  EXPECT_THROW(plan(), report::SceneError);
}

TEST_F(LaunchPlanTest, EverySettingReachesEveryProgram) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  options_.settings = {"time.step=1e-5", "title=two words"};
  for (const ProgramStart& start : {plan().servers[0], plan().servers[1], plan().leader}) {
    EXPECT_THAT(start.command, Contains("time.step=1e-5")) << start.name;
    EXPECT_THAT(start.command, Contains("title=two words")) << start.name;
  }
}

TEST_F(LaunchPlanTest, ProgramsRunOnTheirHosts) {
  std::ofstream(programs_ / "couplet") << "program";
  scene_.mutable_flow()->mutable_navier_stokes();
  scene_.mutable_solid();
  options_.flow_ranks = 3;
  options_.keys = "/my/keys";
  v1::Hosts& hosts = hosts_.emplace();
  hosts.set_network("10.0.0.0/24");
  for (const char* name : {"a", "b"}) {
    v1::FlowHost& host = *hosts.add_flow();
    host.set_name(name), host.set_slots(2), host.set_address("10.0.0.1");
  }
  hosts.mutable_solid()->set_name("c"), hosts.mutable_solid()->set_address("10.0.0.3");
  hosts.mutable_solid()->set_threads(7);
  hosts.mutable_coupler()->set_name("c");
  const LaunchPlan found = plan();
  ASSERT_THAT(found.servers, SizeIs(2));
  EXPECT_EQ(found.servers[0].host, "a");
  EXPECT_EQ(found.servers[0].command.front(), "mpirun");
  EXPECT_THAT(found.servers[0].command,
              IsSupersetOf(Words{"--host", "a:2,b:2", "-n", "3", "plm_rsh_agent", "ssh -o BatchMode=yes",
                                 "btl_tcp_if_include", "10.0.0.0/24", "tcp://10.0.0.1:*", "--keys", "/my/keys"}));
  EXPECT_EQ(found.servers[1].host, "c");
  EXPECT_THAT(found.servers[1].command, IsSupersetOf(Words{"tcp://10.0.0.3:*", "--threads", "7"}));
  EXPECT_EQ(found.leader.host, "c");
  EXPECT_EQ(found.leader.name, "coupler");

  options_.flow_ranks = 5;
  EXPECT_THROW(plan(), report::SceneError) << "there are four slots";
  options_.flow_ranks = 3;
  options_.transport = "mpi";
  EXPECT_THROW(plan(), report::SceneError);
  options_.transport = "";
  options_.keys.clear();
  EXPECT_THROW(plan(), report::SceneError);
}

TEST_F(LaunchPlanTest, KeysReachEveryProgram) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  options_.keys = "/my/keys";
  for (const ProgramStart& start : {plan().servers[0], plan().servers[1], plan().leader}) {
    EXPECT_THAT(start.command, IsSupersetOf(Words{"--keys", "/my/keys"})) << start.name;
  }
  options_.transport = "mpi";
  EXPECT_THROW(plan(), report::SceneError);
}

TEST_F(LaunchPlanTest, ServersAreReachedOnThisMachineOnlyUnlessTheSceneSaysOtherwise) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  EXPECT_THAT(plan().servers[0].command, Contains("ipc:///sockets/flow"));
  scene_.mutable_coupling()->set_listen("tcp://10.0.0.5:*");
  EXPECT_THAT(plan().servers[0].command, Contains("tcp://10.0.0.5:*"));
}

TEST_F(LaunchPlanTest, MpiIsOneJobOfThreePrograms) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  options_.transport = "mpi";
  const LaunchPlan found = plan();
  EXPECT_THAT(found.servers, IsEmpty());
  EXPECT_EQ(found.leader.command.front(), "mpirun");
  for (const char* name : {"coupler", "flow-server", "solid-server"}) {
    EXPECT_THAT(found.leader.command, Contains((programs_ / name).string()));
  }
}

TEST_F(LaunchPlanTest, TransportOnTheCommandLineWinsOverTheScene) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  scene_.mutable_coupling()->set_transport(v1::MPI);
  EXPECT_EQ(plan().transport, "mpi");
  options_.transport = "zmq";
  EXPECT_EQ(plan().transport, "zmq");
}

TEST_F(LaunchPlanTest, MemoryTransportIsRefusedWithWhatToChooseInstead) {
  scene_.mutable_flow();
  scene_.mutable_solid();
  scene_.mutable_coupling()->set_transport(v1::MEMORY);
  try {
    plan();
    FAIL() << "was not refused";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("choose ZEROMQ or MPI"));
  }
}

TEST_F(LaunchPlanTest, MissingProgramIsNamed) {
  scene_.mutable_solid();
  std::filesystem::remove(programs_ / "solid-server");
  try {
    plan();
    FAIL() << "was not noticed";
  } catch (const report::FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("solid-server: this program is missing"));
  }
}

}  // namespace
}  // namespace couplet::launcher
