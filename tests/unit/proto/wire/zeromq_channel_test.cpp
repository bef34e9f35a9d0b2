// What only a channel over ZeroMQ can get wrong: addresses, strangers, processes that are killed or frozen.

#include "proto/wire/zeromq_channel.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <tuple>
#include <zmq.hpp>

#include "proto/report/failure.hpp"
#include "proto/wire/zeromq_address.hpp"
#include "tests/unit/proto/wire/test_keys.hpp"

namespace couplet::wire {

namespace {

Frames message_of(std::string_view text) {
  Frames message;
  message.push_back(Frame::copy_of(text));
  return message;
}

std::string receive_text(Channel& channel) {
  return std::string(channel.receive(deadline_in(30)).value()[0].text());
}

// A server in a process of its own that answers one message and then waits to be killed or frozen.
class ServerProcess {
 public:
  explicit ServerProcess(const std::string& address) {
    int line[2];
    if (pipe(line) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) serve(address, line[1]);
    close(line[1]);
    char text[200] = {};
    if (read(line[0], text, sizeof text - 1) <= 0) throw std::runtime_error("no server");
    close(line[0]);
    address_ = text;
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;
  ~ServerProcess() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  void signal(int number) const { kill(process_, number); }
  const std::string& address() const { return address_; }

 private:
  [[noreturn]] static void serve(const std::string& address, int line) {
    const auto channel = listen_zeromq(address, {});
    const std::string bound = channel->describe();
    if (write(line, bound.data(), bound.size()) < 0) _exit(1);
    close(line);
    channel->receive(deadline_in(30));
    channel->send(message_of("here"));
    while (true) pause();
  }
  pid_t process_ = -1;
  std::string address_;
};

class ZeromqPeer : public testing::TestWithParam<std::string> {};

TEST_P(ZeromqPeer, ThatIsKilledIsLostAtOnce) {
  const ServerProcess server(GetParam());
  const auto coupler = connect_zeromq(server.address(), {});
  coupler->send(message_of("there?"));
  EXPECT_EQ(receive_text(*coupler), "here");
  server.signal(SIGKILL);
  EXPECT_THROW(coupler->receive(deadline_in(30)), report::PeerError);
}

TEST_P(ZeromqPeer, ThatIsFrozenIsLostWithinTheHeartbeatDeadline) {
  const ServerProcess server(GetParam());
  ZeromqOptions options;
  options.heartbeat_deadline = 1;
  const auto coupler = connect_zeromq(server.address(), options);
  coupler->send(message_of("there?"));
  EXPECT_EQ(receive_text(*coupler), "here");
  server.signal(SIGSTOP);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_THROW(coupler->receive(deadline_in(30)), report::PeerError);
  // The deadline is 1 s; the rest is for a loaded machine, and far from the 30 s of the receive.
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(10));
}

// Nobody runs the server's code while it sleeps: ZeroMQ's own thread answers the heartbeats.
TEST_P(ZeromqPeer, ThatComputesForLongerThanTheHeartbeatIsAlive) {
  const ServerProcess server(GetParam());
  ZeromqOptions options;
  options.heartbeat_deadline = 0.5;
  const auto coupler = connect_zeromq(server.address(), options);
  coupler->send(message_of("there?"));
  EXPECT_EQ(receive_text(*coupler), "here");
  EXPECT_FALSE(coupler->receive(deadline_in(1)).has_value());
}

INSTANTIATE_TEST_SUITE_P(Transports, ZeromqPeer, testing::Values("tcp://127.0.0.1:*", "ipc://*"),
                         [](const auto& address) { return address.param.substr(0, 3); });

TEST(ZeromqChannel, AServerWhomNobodyCallsGivesUpAtItsDeadline) {
  ZeromqOptions options;
  options.connect_deadline = 0.1;
  const auto server = listen_zeromq("ipc://*", options);
  try {
    server->receive(deadline_in(30));
    FAIL() << "it waited for ever";
  } catch (const report::PeerError& fault) {
    EXPECT_EQ(fault.sentence(), "no coupler has come within 0.1 s");
  }
}

TEST(ZeromqChannel, ACouplerWhomNobodyAnswersGivesUpAtItsDeadline) {
  ZeromqOptions options;
  options.connect_deadline = 0.1;
  const auto coupler = connect_zeromq("ipc://@couplet-nobody-is-there", options);
  coupler->send(message_of("anybody?"));
  try {
    coupler->receive(deadline_in(30));
    FAIL() << "it waited for ever";
  } catch (const report::PeerError& fault) {
    EXPECT_EQ(fault.sentence(), "no server has answered there within 0.1 s");
  }
}

TEST(ZeromqChannel, AServerMayAppearAfterTheCoupler) {
  const std::string address = "ipc://@couplet-late-server-" + std::to_string(getpid());
  const auto coupler = connect_zeromq(address, {});
  coupler->send(message_of("hello"));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const auto server = listen_zeromq(address, {});
  EXPECT_EQ(receive_text(*server), "hello");
}

TEST(ZeromqChannel, AStrangerIsIgnoredWithOneLine) {
  const auto server = listen_zeromq("tcp://127.0.0.1:*", {});
  const auto coupler = connect_zeromq(server->describe(), {});
  coupler->send(message_of("first"));
  EXPECT_EQ(receive_text(*server), "first");
  testing::internal::CaptureStderr();
  {
    const auto stranger = connect_zeromq(server->describe(), {});
    stranger->send(message_of("me too"));
    stranger->send(message_of("hear me"));
    EXPECT_FALSE(server->receive(deadline_in(0.5)).has_value());
    EXPECT_FALSE(stranger->receive(deadline_in(0.1)).has_value());
  }
  const std::string lines = testing::internal::GetCapturedStderr();
  EXPECT_EQ(lines, server->describe() + ": a second program tries to connect and is ignored\n");
  // That the stranger goes is no loss.
  coupler->send(message_of("second"));
  EXPECT_EQ(receive_text(*server), "second");
  server->send(message_of("answer"));
  EXPECT_EQ(receive_text(*coupler), "answer");
}

TEST(ZeromqChannel, WhatDoesNotSpeakZeromqIsNotThePeer) {
  ZeromqOptions options;
  options.connect_deadline = 1;
  const auto server = listen_zeromq("tcp://127.0.0.1:*", options);
  zmq::context_t context;
  zmq::socket_t rude(context, ZMQ_STREAM);
  rude.set(zmq::sockopt::linger, 0);
  rude.connect(server->describe());
  zmq::message_t identity;
  (void)rude.recv(identity);
  rude.send(identity, zmq::send_flags::sndmore);
  rude.send(zmq::str_buffer("GET / HTTP/1.1\r\n\r\n"), zmq::send_flags::none);
  EXPECT_THROW(server->receive(deadline_in(30)), report::PeerError);
}

TEST(ZeromqChannel, AnEndThatIsGivenUpDoesNotHang) {
  const auto before = std::chrono::steady_clock::now();
  {
    const auto coupler = connect_zeromq("tcp://127.0.0.1:9", {});
    for (int i = 0; i < 10; ++i) coupler->send(message_of(std::string(100'000, 'x')));
  }
  // Unsent messages are waited for by 2 s; a hang would be for ever.
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(20));
}

// A server with keys, and a coupler that has those of `options`.
class EncryptedServer : public testing::Test {
 protected:
  EncryptedServer() {
    ZeromqOptions options;
    std::tie(right_.keys, options.keys) = make_keys_of_both();
    server_ = listen_zeromq("tcp://127.0.0.1:*", options);
  }

  // What the server says while somebody knocks, and that nobody gets in.
  std::string knock(const ZeromqOptions& options, std::string& answer) {
    testing::internal::CaptureStderr();
    const auto stranger = connect_zeromq(server_->describe(), options);
    stranger->send(message_of("obey me"));
    EXPECT_FALSE(server_->receive(deadline_in(0.3)).has_value());
    try {
      EXPECT_FALSE(stranger->receive(deadline_in(0.3)).has_value());
    } catch (const report::PeerError& fault) {
      answer = fault.sentence();
    }
    return testing::internal::GetCapturedStderr();
  }

  // After all that, the right one is let in.
  void expect_the_right_one_gets_in() {
    const auto coupler = connect_zeromq(server_->describe(), right_);
    coupler->send(message_of("hello"));
    EXPECT_EQ(receive_text(*server_), "hello");
    server_->send(message_of("welcome"));
    EXPECT_EQ(receive_text(*coupler), "welcome");
  }

  ZeromqOptions right_;
  std::unique_ptr<Channel> server_;
};

TEST_F(EncryptedServer, TurnsAwayWhoHasAnotherKey) {
  ZeromqOptions wrong = right_;
  const KeyPair other = make_key_pair();
  wrong.keys->secret_key = other.secret_key, wrong.keys->public_key = other.public_key;
  std::string answer;
  EXPECT_NE(knock(wrong, answer).find("has another key, or none, was turned away"), std::string::npos);
  EXPECT_EQ(answer, "the program there has other keys, or none");
  expect_the_right_one_gets_in();
}

TEST_F(EncryptedServer, TurnsAwayWhoTakesItForAnotherServer) {
  ZeromqOptions wrong = right_;
  wrong.keys->peer_public_key = make_key_pair().public_key;
  std::string answer;
  EXPECT_NE(knock(wrong, answer).find("was turned away"), std::string::npos);
  EXPECT_EQ(answer, "the program there has other keys, or none");
  expect_the_right_one_gets_in();
}

TEST_F(EncryptedServer, TurnsAwayWhoDoesNotEncrypt) {
  std::string answer;
  EXPECT_NE(knock({}, answer).find("was turned away"), std::string::npos);
  EXPECT_EQ(answer, "the program there asks for a key, or is no server");
  expect_the_right_one_gets_in();
}

TEST(ZeromqChannel, ACouplerWithKeysDoesNotTalkToAServerWithoutThem) {
  const auto server = listen_zeromq("tcp://127.0.0.1:*", {});
  ZeromqOptions options;
  options.keys = make_keys_of_both().first;
  const auto coupler = connect_zeromq(server->describe(), options);
  coupler->send(message_of("secret"));
  EXPECT_THROW(coupler->receive(deadline_in(30)), report::PeerError);
  EXPECT_FALSE(server->receive(deadline_in(0.1)).has_value());
}

TEST(ZeromqChannel, LeavesThisMachineWithKeysOnly) {
  for (const char* address :
       {"tcp://*:*", "tcp://0.0.0.0:*", "tcp://[::]:5555", "tcp://eth0:5555", "tcp://10.0.0.5:*"}) {
    try {
      listen_zeromq(address, {});
      ADD_FAILURE() << address << " was bound";
    } catch (const report::SceneError& fault) {
      EXPECT_NE(fault.advice().find("--keys"), std::string::npos);
    }
  }
  EXPECT_THROW(connect_zeromq("tcp://10.0.0.5:5555", {}), report::SceneError);
  ZeromqOptions options;
  options.keys = make_keys_of_both().second;
  EXPECT_NO_THROW(listen_zeromq("tcp://0.0.0.0:*", options));
}

TEST(ZeromqChannel, AnAddressInUseIsNamed) {
  const auto first = listen_zeromq("tcp://127.0.0.1:*", {});
  try {
    listen_zeromq(first->describe(), {});
    FAIL() << "bound twice";
  } catch (const report::PeerError& fault) {
    EXPECT_EQ(fault.where(), first->describe());
    EXPECT_EQ(fault.sentence(), "cannot bind: Address already in use");
  }
}

TEST(ZeromqAddress, KnowsWhatStaysOnThisMachine) {
  for (const char* local : {"ipc://@x", "ipc:///tmp/x", "tcp://127.0.0.1:5555", "tcp://127.3.2.1:*",
                            "tcp://localhost:1", "tcp://[::1]:5555"})
    EXPECT_TRUE(is_local_address(local)) << local;
  for (const char* remote : {"tcp://128.0.0.1:5555", "tcp://127.evil.example:5", "tcp://127.0.0.1.example:5",
                             "tcp://*:5", "tcp://node7:5555"})
    EXPECT_FALSE(is_local_address(remote)) << remote;
}

TEST(ZeromqAddress, RefusesWhatIsNone) {
  for (const char* wrong :
       {"", "localhost:5555", "http://localhost:1", "tcp://", "tcp://localhost", "tcp://:5555", "tcp://localhost:port",
        "tcp://localhost:70000", "tcp://localhost:", "ipc://", "inproc://x"})
    EXPECT_THROW(check_zeromq_address(wrong), report::SceneError) << wrong;
  EXPECT_THROW(check_zeromq_address("ipc://" + std::string(200, 'x')), report::SceneError);
  for (const char* right : {"tcp://localhost:5555", "tcp://*:*", "tcp://[::1]:0", "ipc://x", "ipc://*"})
    EXPECT_NO_THROW(check_zeromq_address(right)) << right;
}

}  // namespace

}  // namespace couplet::wire
