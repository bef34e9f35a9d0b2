// A server as users and the launcher meet it: command line, what it prints, how it ends.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/participant/remote_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/wire/message.hpp"
#include "proto/wire/session_rules.hpp"
#include "proto/wire/zeromq_channel.hpp"
#include "tests/unit/proto/participant/child_program.hpp"

namespace couplet::participant {

namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

ChildProgram server(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), COUPLET_SPRING_SERVER);
  return ChildProgram(std::move(arguments));
}

std::string address_of(const ChildProgram& program) {
  const std::string line = program.read_line(), start = "listening ";
  if (line.rfind(start, 0) != 0) throw std::runtime_error("the server prints '" + line + "'");
  return line.substr(start.size());
}

surface::FieldSet force() {
  return {{"force", "N", surface::NodeArray::Ones(2, 3)}};
}

void expect_one_line(const std::string& text) {
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_THAT(text, EndsWith("\n"));
}

// A conversation up to the opened scene, by hand: this coupler can vanish without a farewell.
void open_by_hand(wire::Channel& channel) {
  v1::Request hello, open;
  hello.set_sequence(1);
  hello.mutable_hello()->set_protocol(wire::protocol_version);
  open.set_sequence(2);
  open.mutable_open_scene();
  for (const auto* request : {&hello, &open}) {
    channel.send(wire::encode_request(*request, {}, nullptr));
    if (!channel.receive(wire::deadline_in(30))) throw std::runtime_error("no answer");
  }
}

TEST(ServerProgram, HelpNamesEveryVerb) {
  auto program = server({"--help"});
  EXPECT_EQ(program.exit_code(), 0);
  for (const char* verb : {"serve", "run", "check", "version"}) EXPECT_THAT(program.output(), HasSubstr(verb));
}

TEST(ServerProgram, HelpOfAVerbNamesItsOptions) {
  auto program = server({"serve", "--help"});
  EXPECT_EQ(program.exit_code(), 0);
  for (const char* option : {"--listen", "--transport", "--threads", "--heartbeat", "--wait", "--keys"})
    EXPECT_THAT(program.output(), HasSubstr(option));
}

TEST(ServerProgram, AWrongCommandLineIsRefusedInOneLine) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"dance"},
                                                       {"serve", "--liste", "tcp://127.0.0.1:*"},
                                                       {"serve", "--heartbeat", "soon"},
                                                       {"serve", "--transport", "pigeon"},
                                                       {"run"},
                                                       {"serve", "--listen", "127.0.0.1:5555"},
                                                       {"serve", "--listen", "tcp://*:*"}};
  for (const auto& arguments : wrong) {
    auto program = server(arguments);
    EXPECT_EQ(program.exit_code(), 2) << testing::PrintToString(arguments);
    EXPECT_THAT(program.errors(), StartsWith("solid-server: "));
    expect_one_line(program.errors());
  }
}

TEST(ServerProgram, ServesOneSessionAndEnds) {
  auto program = server({"serve", "--listen", "tcp://127.0.0.1:*"});
  const std::string address = address_of(program);
  EXPECT_THAT(address, testing::MatchesRegex("tcp://127\\.0\\.0\\.1:[0-9]+"));
  RemoteParticipant remote(wire::connect_zeromq(address, {}), {"solid", "run"});
  remote.open({});
  remote.solve_step({1, 1, 0, 0.1}, force());
  remote.accept_step(1);
  remote.close("finished");
  EXPECT_EQ(program.exit_code(), 0);
  EXPECT_EQ(program.errors(), "results are complete\n");
}

TEST(ServerProgram, ANumericalFailureEndsBothProgramsWithTheSameSentence) {
  auto program = server({"serve", "--listen", "ipc://*"});
  RemoteParticipant remote(wire::connect_zeromq(address_of(program), {}), {"solid", "run"});
  remote.open({});
  EXPECT_THROW(remote.solve_step({1, 99, 0, 0.1}, force()), report::NumericsError);
  remote.close("failed");
  EXPECT_EQ(program.exit_code(), 3);
  EXPECT_EQ(program.errors(), "results are complete\nsolid-server: spring 1: is torn; pull less\n");
}

TEST(ServerProgram, EndsWhenItsCouplerVanishes) {
  auto program = server({"serve"});
  auto coupler = wire::connect_zeromq(address_of(program), {});
  open_by_hand(*coupler);
  coupler.reset();
  EXPECT_EQ(program.exit_code(), 4);
  EXPECT_THAT(program.errors(), StartsWith("results are complete\nsolid-server: tcp://127.0.0.1:"));
}

TEST(ServerProgram, EndsWhenItsCouplerIsFrozen) {
  auto program = server({"serve", "--heartbeat", "0.5"});
  const std::string address = address_of(program);
  const pid_t coupler = fork();
  if (coupler == 0) {
    const auto channel = wire::connect_zeromq(address, {});
    open_by_hand(*channel);
    raise(SIGSTOP);
    _exit(0);
  }
  EXPECT_EQ(program.exit_code(), 4);
  EXPECT_THAT(program.errors(), HasSubstr("gave no sign of life for 0.5 s"));
  kill(coupler, SIGKILL);
  waitpid(coupler, nullptr, 0);
}

TEST(ServerProgram, EndsOrderlyWhenItIsTerminated) {
  auto program = server({"serve"});
  auto coupler = wire::connect_zeromq(address_of(program), {});
  open_by_hand(*coupler);
  program.signal(SIGTERM);
  EXPECT_EQ(program.exit_code(), 4);
  EXPECT_EQ(program.errors(),
            "results are complete\nsolid-server: asked to end by a signal; results are complete up to the last step\n");
}

TEST(ServerProgram, AStepThatIsBeingSolvedIsAnsweredBeforeItEndsOnASignal) {
  auto program = server({"serve"});
  RemoteParticipant remote(wire::connect_zeromq(address_of(program), {}), {"solid", "run"});
  remote.open({});
  remote.start_step({1, 98, 0, 0.1}, force());
  usleep(300'000);  // it takes a second
  program.signal(SIGTERM);
  EXPECT_EQ(remote.finish_step().inner_iterations, 7);
  EXPECT_EQ(program.exit_code(), 4);
  EXPECT_THROW(remote.accept_step(1), report::PeerError);
}

TEST(ServerProgram, GivesUpWhenNoCouplerComes) {
  auto program = server({"serve", "--wait", "0.2"});
  address_of(program);
  EXPECT_EQ(program.exit_code(), 4);
  EXPECT_THAT(program.errors(), HasSubstr("no coupler has come within 0.2 s; start the coupler with this address"));
}

TEST(ServerProgram, ChecksTheSceneThatItIsGivenBeforeItListens) {
  auto program = server({"serve", "/nowhere/scene.txtpb"});
  EXPECT_EQ(program.exit_code(), 5);
  EXPECT_EQ(program.output(), "");
  EXPECT_THAT(program.errors(), HasSubstr("/nowhere/scene.txtpb"));
}

TEST(ServerProgram, CheckPrintsTheEstimateForPeopleAndForScripts) {
  auto people = server({"check", COUPLET_SCENE, "--set", "time.step=1e-5"});
  EXPECT_EQ(people.exit_code(), 0) << people.errors();
  EXPECT_EQ(people.output(), "springs           2\nstable_time_step  1e-05 s\n");
  auto scripts = server({"check", COUPLET_SCENE, "--set", "time.step=1e-5", "--json"});
  EXPECT_EQ(scripts.exit_code(), 0);
  const auto object = nlohmann::json::parse(scripts.output());
  EXPECT_EQ(object.at("stable_time_step").at("value"), 1e-5);
  EXPECT_EQ(object.at("stable_time_step").at("unit"), "s");
}

TEST(ServerProgram, SaysItsVersion) {
  auto program = server({"version"});
  EXPECT_EQ(program.exit_code(), 0);
  EXPECT_THAT(program.output(), StartsWith("solid-server "));
  expect_one_line(program.output());
}

}  // namespace

}  // namespace couplet::participant
