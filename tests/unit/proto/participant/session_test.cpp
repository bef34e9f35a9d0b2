// Both ends of a session over a memory channel: what the coupler says is what the participant is asked.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <exception>
#include <thread>

#include "proto/participant/remote_participant.hpp"
#include "proto/participant/serve_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/wire/memory_channel.hpp"
#include "proto/wire/message.hpp"
#include "tests/unit/proto/participant/spring_participant.hpp"

namespace couplet::participant {

namespace {

using testing::ElementsAre;

// A server with a spring behind it, in a thread of its own.
class SpringServer {
 public:
  explicit SpringServer(std::unique_ptr<wire::Channel> channel, ServeOptions options = {})
      : channel_(std::move(channel)), options_(std::move(options)) {
    options_.program = "spring-server";
  }
  SpringServer(const SpringServer&) = delete;
  SpringServer& operator=(const SpringServer&) = delete;
  ~SpringServer() { end(); }

  void begin() {
    thread_ = std::thread([this] {
      try {
        serve_participant(*channel_, spring, options_);
      } catch (...) {
        fault_ = std::current_exception();
      }
      channel_.reset();
    });
  }

  // Waits for the end of the session; throws what serve_participant threw.
  void end() {
    if (thread_.joinable()) thread_.join();
    if (auto fault = std::exchange(fault_, nullptr); fault && !std::uncaught_exceptions())
      std::rethrow_exception(fault);
  }

  std::string end_with_failure() {
    try {
      end();
    } catch (const report::Failure& failure) {
      return failure.what();
    } catch (const std::exception& other) {
      return std::string("exception: ") + other.what();
    }
    return "";
  }

  SpringParticipant spring{2};

 private:
  std::unique_ptr<wire::Channel> channel_;
  ServeOptions options_;
  std::exception_ptr fault_;
  std::thread thread_;
};

surface::FieldSet force(double value) {
  return {{"force", "N", surface::NodeArray::Constant(2, 3, value)}};
}

OpenRequest open_request() {
  OpenRequest request;
  request.scene.set_title("springs");
  request.scene_folder = "/scenes";
  request.run_folder = "/runs/1";
  return request;
}

TEST(Session, AsksTheParticipantWhatTheCouplerAsks) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});

  OpenRequest request = open_request();
  request.resume_from = "old.h5";
  request.peer_surface.emplace();
  request.peer_surface->node_position = surface::NodeArray::Constant(1, 3, 7);
  const Opened opened = remote.open(request);
  EXPECT_EQ(server.spring.opened.scene.title(), "springs");
  EXPECT_EQ(server.spring.opened.scene_folder, "/scenes");
  EXPECT_EQ(server.spring.opened.run_folder, "/runs/1");
  EXPECT_EQ(server.spring.opened.resume_from, "old.h5");
  EXPECT_EQ(server.spring.opened.peer_surface->node_position(0, 2), 7);
  EXPECT_EQ(opened.surface.n_nodes(), 2);
  EXPECT_EQ(opened.surface.marker.at("first"), 0);
  EXPECT_THAT(opened.needs, ElementsAre("force"));
  EXPECT_THAT(opened.offers, ElementsAre("displacement", "velocity"));
  EXPECT_EQ(opened.fields[1].unit, "m/s");

  const StepSolved solved = remote.solve_step({1, 1, 0, 0.01}, force(5));
  EXPECT_EQ(solved.seconds, 0.25);
  EXPECT_EQ(solved.inner_iterations, 7);
  EXPECT_EQ(solved.residual, 1e-9);
  // u(t) = f/k (1 - cos w t), w = 5 1/s; computed by the same formula at the other end, so equal to the last bits.
  EXPECT_NEAR(solved.fields[0].values(1, 2), 0.1 * (1 - std::cos(0.05)), 1e-16);

  const auto quantities = remote.accept_step(1);
  EXPECT_EQ(quantities.at(0).name, "energy");
  EXPECT_EQ(quantities.at(0).unit, "J");
  EXPECT_EQ(remote.write_checkpoint("c.h5"), 123U);
  const auto costs = remote.close("finished");
  EXPECT_EQ(costs.at(1).name, "peak_memory_bytes");
  EXPECT_EQ(costs.at(1).value, 1e6);
  server.end();
  EXPECT_THAT(server.spring.calls, ElementsAre("open", "solve 1/1", "accept 1", "checkpoint c.h5", "close finished"));
}

TEST(Session, GivesTheSameBitsAsAParticipantInThisProcess) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  SpringParticipant local(2);
  remote.open(open_request());
  local.open(open_request());
  for (int step = 1; step <= 5; ++step) {
    const auto load = force(std::sin(step));
    const auto far = remote.solve_step({step, 1, 0.1 * step, 0.1}, load);
    const auto near = local.solve_step({step, 1, 0.1 * step, 0.1}, load);
    EXPECT_EQ(far.fields[0].values, near.fields[0].values);
    EXPECT_EQ(far.fields[1].values, near.fields[1].values);
    EXPECT_EQ(remote.accept_step(step).at(0).value, local.accept_step(step).at(0).value);
  }
  remote.close("finished");
}

TEST(Session, TwoParticipantsWorkAtTheSameTime) {
  auto [first_end, first_server_end] = wire::make_memory_channel();
  auto [second_end, second_server_end] = wire::make_memory_channel();
  SpringServer first(std::move(first_server_end)), second(std::move(second_server_end));
  // Each solve waits until the other one has begun: one after the other they would never end.
  std::atomic<int> n_begun = 0;
  const auto meet = [&n_begun] {
    ++n_begun;
    while (n_begun < 2) std::this_thread::yield();
  };
  first.spring.on_solve = second.spring.on_solve = meet;
  first.begin();
  second.begin();
  RemoteParticipant a(std::move(first_end), {"flow", "run"}), b(std::move(second_end), {"solid", "run"});
  a.open(open_request());
  b.open(open_request());
  a.start_step({1, 1, 0, 0.1}, force(1));
  b.start_step({1, 1, 0, 0.1}, force(1));
  EXPECT_EQ(a.finish_step().fields[0].values, b.finish_step().fields[0].values);
  a.close("");
  b.close("");
}

TEST(Session, AFailureArrivesAsWhatItWasAndIsThrownAgainAfterTheClose) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.spring.on_solve = [] { throw report::FileError("results/solid.h5", "the disk is full", "make room"); };
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  remote.open(open_request());
  try {
    remote.solve_step({1, 1, 0, 0.1}, force(1));
    ADD_FAILURE() << "no failure arrived";
  } catch (const report::FileError& failure) {
    EXPECT_STREQ(failure.what(), "results/solid.h5: the disk is full; make room");
  }
  // After a failure only close is allowed.
  EXPECT_THROW(remote.solve_step({1, 2, 0, 0.1}, force(1)), report::PeerError);
  remote.close("failed");
  EXPECT_EQ(server.end_with_failure(), "results/solid.h5: the disk is full; make room");
  EXPECT_THAT(server.spring.calls, ElementsAre("open", "solve 1/1", "close failed"));
}

TEST(Session, AStepThatFailsNumericallyMayBeTriedAgain) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  int n_solves = 0;
  server.spring.on_solve = [&n_solves] {
    if (++n_solves == 2) throw report::NumericsError("element 3", "is inverted", "halve the step");
  };
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  remote.open(open_request());
  const StepSolved first = remote.solve_step({1, 1, 0, 0.1}, force(1));
  EXPECT_THROW(remote.solve_step({1, 2, 0, 0.1}, force(1)), report::NumericsError);
  EXPECT_THROW(remote.solve_step({1, 3, 0, 0.1}, {}), report::PeerError);  // without its field: a fault, not numerics
  remote.close("failed");
  EXPECT_NE(server.end_with_failure(), "");

  auto [other_coupler_end, other_server_end] = wire::make_memory_channel();
  SpringServer other(std::move(other_server_end));
  n_solves = 0;
  other.spring.on_solve = [&n_solves] {
    if (++n_solves == 1) throw report::NumericsError("element 3", "is inverted", "halve the step");
  };
  other.begin();
  RemoteParticipant again(std::move(other_coupler_end), {"solid", "run"});
  again.open(open_request());
  EXPECT_THROW(again.solve_step({1, 1, 0, 0.1}, force(1)), report::NumericsError);
  EXPECT_EQ(again.solve_step({1, 1, 0, 0.1}, force(1)).fields.front().values, first.fields.front().values);
  again.accept_step(1);
  again.close("done");
  EXPECT_EQ(other.end_with_failure(), "");
}

TEST(Session, AFailedStepThatIsTheLastWordIsThrownAfterTheClose) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.spring.on_solve = [] { throw report::NumericsError("element 3", "is inverted", "halve the step"); };
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  remote.open(open_request());
  EXPECT_THROW(remote.solve_step({1, 1, 0, 0.1}, force(1)), report::NumericsError);
  EXPECT_THROW(remote.solve_step({1, 1, 0, 0.05}, force(1)), report::NumericsError);
  remote.close("failed");
  EXPECT_EQ(server.end_with_failure(), "element 3: is inverted; halve the step");
}

TEST(Session, AFailureToOpenIsClosedToo) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.spring.on_open = [] { throw std::logic_error("index out of range"); };
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  try {
    remote.open(open_request());
    ADD_FAILURE() << "no failure arrived";
  } catch (const report::Failure& failure) {
    EXPECT_EQ(failure.kind(), report::FailureKind::bug);
    EXPECT_NE(failure.sentence().find("index out of range"), std::string::npos);
  }
  remote.close("failed");
  EXPECT_EQ(server.end_with_failure(), "exception: index out of range");
}

TEST(Session, ACouplerThatFailsClosesItsServers) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.begin();
  {
    RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
    remote.open(open_request());
    remote.start_step({1, 1, 0, 0.1}, force(1));
  }
  server.end();  // without a failure
  EXPECT_THAT(server.spring.calls, ElementsAre("open", "solve 1/1", "close the coupler ends early"));
}

TEST(Session, AServerWhoseCouplerIsLostCompletesItsResults) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.begin();
  v1::Request request;
  request.set_sequence(1);
  request.mutable_hello()->set_protocol(1);
  coupler_end->send(wire::encode_request(request, {}, nullptr));
  request.set_sequence(2);
  request.mutable_open_scene();
  coupler_end->send(wire::encode_request(request, {}, nullptr));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(coupler_end->receive(wire::deadline_in(30)).has_value());
  coupler_end.reset();
  EXPECT_NE(server.end_with_failure().find("the other end of the channel was closed"), std::string::npos);
  EXPECT_EQ(server.spring.calls.back().substr(0, 5), "close");
}

TEST(Session, AServerThatIsAskedToEndCompletesItsResults) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  std::atomic<bool> should_end = false;
  ServeOptions options;
  options.should_end = [&should_end] { return should_end.load(); };
  SpringServer server(std::move(server_end), options);
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  remote.open(open_request());
  should_end = true;
  EXPECT_EQ(server.end_with_failure(), "asked to end by a signal; results are complete up to the last step");
  EXPECT_EQ(server.spring.calls.back().substr(0, 5), "close");
  EXPECT_THROW(remote.accept_step(1), report::PeerError);
}

TEST(Session, ASilentServerIsGivenUpAtTheReplyDeadline) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  RemoteOptions options{"solid", "run"};
  options.hello_deadline = 0.1;
  RemoteParticipant remote(std::move(coupler_end), options);
  try {
    remote.open(open_request());
    ADD_FAILURE() << "it waited for ever";
  } catch (const report::PeerError& fault) {
    EXPECT_STREQ(fault.what(),
                 "solid at memory: has not answered hello within 0.1 s; it may be serving another coupler");
  }
}

TEST(Session, AFieldOfTheWrongSizeIsRefusedByTheServer) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringServer server(std::move(server_end));
  server.begin();
  RemoteParticipant remote(std::move(coupler_end), {"solid", "run"});
  remote.open(open_request());
  try {
    remote.solve_step({1, 1, 0, 0.1}, {{"force", "N", surface::NodeArray::Zero(3, 3)}});
    ADD_FAILURE() << "3 rows were taken for 2 nodes";
  } catch (const report::PeerError& fault) {
    EXPECT_EQ(fault.sentence(), "field force has 3 rows for 2 nodes");
  }
  remote.close("failed");
  EXPECT_NE(server.end_with_failure(), "");
}

}  // namespace

}  // namespace couplet::participant
