// The rule that makes a repeated request harmless, and what else a server refuses, message by message.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "proto/participant/remote_participant.hpp"
#include "proto/participant/serve_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/wire/memory_channel.hpp"
#include "proto/wire/message.hpp"
#include "proto/wire/session_rules.hpp"
#include "tests/unit/proto/participant/spring_participant.hpp"

namespace couplet::participant {

namespace {

using testing::ElementsAre;

// A coupler that says whatever a test wants, to a spring that is served in another thread.
class Conversation : public testing::Test {
 protected:
  Conversation() {
    auto [coupler_end, server_end] = wire::make_memory_channel();
    coupler_ = std::move(coupler_end);
    server_ = std::thread([this, channel = std::move(server_end)]() mutable {
      try {
        ServeOptions options;
        options.program = "spring-server";
        serve_participant(*channel, spring_, options);
      } catch (const report::Failure& failure) {
        end_ = failure.what();
      }
      channel.reset();
    });
  }
  ~Conversation() override { end(); }

  std::string end() {
    coupler_.reset();
    if (server_.joinable()) server_.join();
    return end_;
  }

  static v1::Request hello() {
    v1::Request request;
    request.mutable_hello()->set_protocol(wire::protocol_version);
    return request;
  }
  static v1::Request open_scene() {
    v1::Request request;
    request.mutable_open_scene();
    return request;
  }
  static v1::Request solve_step() {
    v1::Request request;
    auto* step = request.mutable_solve_step();
    step->set_step(1);
    step->set_iteration(1);
    step->set_duration(0.1);
    return request;
  }
  static v1::Request accept_step() {
    v1::Request request;
    request.mutable_accept_step()->set_step(1);
    return request;
  }
  static v1::Request close() {
    v1::Request request;
    request.mutable_close()->set_reason("end");
    return request;
  }

  wire::Frames say(std::uint64_t sequence, v1::Request request) {
    request.set_sequence(sequence);
    surface::FieldSet fields;
    if (request.has_solve_step()) fields = {{"force", "N", surface::NodeArray::Ones(2, 3)}};
    return say(wire::encode_request(request, fields, nullptr));
  }
  wire::Frames say(wire::Frames message) {
    coupler_->send(std::move(message));
    return std::move(coupler_->receive(wire::deadline_in(30)).value());
  }
  v1::Reply ask(std::uint64_t sequence, const v1::Request& request) {
    return wire::decode_reply(say(sequence, request), "spring");
  }
  void open() {
    ask(1, hello());
    ASSERT_TRUE(ask(2, open_scene()).has_scene_ready());
  }

  SpringParticipant spring_{2};
  std::unique_ptr<wire::Channel> coupler_;
  std::thread server_;
  std::string end_;
};

TEST_F(Conversation, ARepeatedRequestIsAnsweredByTheSameBytesAndComputesNothing) {
  open();
  const wire::Frames first = say(3, solve_step());
  const wire::Frames again = say(3, solve_step());
  ASSERT_EQ(first.size(), 3U);
  ASSERT_EQ(again.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(first[i].text(), again[i].text());
  EXPECT_TRUE(ask(4, accept_step()).has_step_accepted());
  EXPECT_TRUE(ask(4, accept_step()).has_step_accepted());
  EXPECT_TRUE(ask(5, close()).has_closed());
  EXPECT_EQ(end(), "");
  EXPECT_THAT(spring_.calls, ElementsAre("open", "solve 1/1", "accept 1", "close end"));
}

TEST_F(Conversation, ALateRequestIsRefusedAndTheSessionGoesOn) {
  open();
  ask(3, solve_step());
  const v1::Reply late = ask(2, open_scene());
  EXPECT_EQ(late.sequence(), 2U);
  EXPECT_EQ(late.failure().kind(), v1::Failure::PEER);
  EXPECT_EQ(late.failure().sentence(), "request 2 comes after request 3 was answered");
  EXPECT_TRUE(ask(4, accept_step()).has_step_accepted());
  EXPECT_TRUE(ask(5, close()).has_closed());
  EXPECT_EQ(end(), "");
}

TEST_F(Conversation, ASkippedRequestEndsTheSession) {
  open();
  const v1::Reply skipped = ask(4, solve_step());
  EXPECT_EQ(skipped.failure().kind(), v1::Failure::PEER);
  EXPECT_EQ(skipped.failure().sentence(), "request 4 follows request 2: one in between is missing");
  EXPECT_TRUE(ask(5, solve_step()).has_failure());
  EXPECT_TRUE(ask(6, close()).has_closed());
  EXPECT_NE(end().find("one in between is missing"), std::string::npos);
}

TEST_F(Conversation, ARequestOutOfOrderIsRefusedAndNamesTheState) {
  open();
  const v1::Reply refused = ask(3, accept_step());
  EXPECT_EQ(refused.failure().kind(), v1::Failure::PEER);
  EXPECT_EQ(refused.failure().sentence(), "accept-step is not allowed in state opened");
  EXPECT_TRUE(ask(4, solve_step()).has_failure());
  EXPECT_TRUE(ask(5, close()).has_closed());
  EXPECT_NE(end().find("accept-step is not allowed"), std::string::npos);
  EXPECT_THAT(spring_.calls, ElementsAre("open", "close end"));
}

TEST_F(Conversation, AnotherProtocolIsRefusedByBothCommits) {
  v1::Request request = hello();
  request.mutable_hello()->set_protocol(2);
  request.mutable_hello()->set_commit("abc123");
  const v1::Reply refused = ask(1, request);
  EXPECT_EQ(refused.failure().kind(), v1::Failure::PEER);
  EXPECT_NE(
      refused.failure().sentence().find("the coupler (commit abc123) speaks protocol 2, this spring-server (commit "),
      std::string::npos);
  EXPECT_TRUE(ask(2, close()).has_closed());
  EXPECT_NE(end(), "");
}

TEST_F(Conversation, RubbishIsAnsweredWithoutANumber) {
  open();
  wire::Frames rubbish;
  rubbish.push_back(wire::Frame::copy_of("\x05rubbish"));
  const v1::Reply refused = wire::decode_reply(say(std::move(rubbish)), "spring");
  EXPECT_EQ(refused.sequence(), 0U);
  EXPECT_EQ(refused.failure().kind(), v1::Failure::PEER);
  EXPECT_TRUE(ask(3, close()).has_closed());
  EXPECT_NE(end(), "");
}

TEST_F(Conversation, ADamagedArrayIsRefusedBeforeAnythingIsComputed) {
  open();
  v1::Request request = solve_step();
  request.set_sequence(3);
  wire::Frames message = wire::encode_request(request, {{"force", "N", surface::NodeArray::Ones(2, 3)}}, nullptr);
  message[1].data()[11] ^= std::byte{1};
  const v1::Reply refused = wire::decode_reply(say(std::move(message)), "spring");
  EXPECT_EQ(refused.sequence(), 3U);
  EXPECT_NE(refused.failure().sentence().find("array 'force' was damaged"), std::string::npos);
  EXPECT_TRUE(ask(4, close()).has_closed());
  EXPECT_NE(end(), "");
  EXPECT_THAT(spring_.calls, ElementsAre("open", "close end"));
}

TEST_F(Conversation, AServerThatWasNeverOpenedCanBeClosed) {
  ask(1, hello());
  EXPECT_TRUE(ask(2, close()).has_closed());
  EXPECT_EQ(end(), "");
  EXPECT_TRUE(spring_.calls.empty());
}

// Loses every second message and doubles the others, both ways. Only the last reply always arrives: a server that has
// ended repeats nothing.
class BadLine : public wire::Channel {
 public:
  explicit BadLine(std::unique_ptr<wire::Channel> channel) : channel_(std::move(channel)) {}
  void send(wire::Frames message) override {
    if (++n_sent_ % 2 == 1) return;
    channel_->send(wire::share(message));
    channel_->send(std::move(message));
  }
  std::optional<wire::Frames> receive(wire::Deadline deadline) override {
    if (doubled_) return std::exchange(doubled_, std::nullopt);
    while (auto message = channel_->receive(deadline)) {
      if (++n_received_ % 2 == 1 && !wire::decode_reply(*message, "spring").has_closed()) continue;
      doubled_ = wire::share(*message);
      return message;
    }
    return std::nullopt;
  }
  std::string describe() const override { return "a bad line"; }

 private:
  std::unique_ptr<wire::Channel> channel_;
  int n_sent_ = 0, n_received_ = 0;
  std::optional<wire::Frames> doubled_;
};

TEST(Repeats, CarryASessionOverALineThatLosesAndDoublesMessages) {
  auto [coupler_end, server_end] = wire::make_memory_channel();
  SpringParticipant spring(2), local(2);
  std::thread server([&spring, &channel = server_end] {
    ServeOptions options;
    options.program = "spring-server";
    try {
      serve_participant(*channel, spring, options);
    } catch (const report::Failure& failure) {
      ADD_FAILURE() << failure.what();
    }
  });
  RemoteOptions options{"solid", "run"};
  options.repeat_interval = 0.01;
  {
    RemoteParticipant remote(std::make_unique<BadLine>(std::move(coupler_end)), options);
    remote.open({});
    local.open({});
    for (int step = 1; step <= 20; ++step) {
      const surface::FieldSet force{{"force", "N", surface::NodeArray::Constant(2, 3, std::sin(step))}};
      EXPECT_EQ(remote.solve_step({step, 1, 0, 0.1}, force).fields[0].values,
                local.solve_step({step, 1, 0, 0.1}, force).fields[0].values);
      EXPECT_EQ(remote.accept_step(step).at(0).value, local.accept_step(step).at(0).value);
    }
    remote.close("end");
  }
  server.join();
  EXPECT_EQ(spring.calls.size(), 42U);  // open, 20 solves, 20 accepts, close: nothing was done twice
}

}  // namespace

}  // namespace couplet::participant
