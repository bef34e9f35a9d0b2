// A program that shares no code with Couplet takes the place of the solid server.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "proto/participant/remote_participant.hpp"
#include "proto/wire/message.hpp"
#include "proto/wire/session_rules.hpp"
#include "proto/wire/zeromq_channel.hpp"

namespace couplet {

namespace {

// The program in a process of its own; its address is what it prints.
class ExternalSolid {
 public:
  ExternalSolid() {
    int line[2];
    if (pipe2(line, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      dup2(line[1], STDOUT_FILENO);
      execl(COUPLET_EXTERNAL_SOLID, COUPLET_EXTERNAL_SOLID, nullptr);
      _exit(127);
    }
    close(line[1]);
    std::FILE* output = fdopen(line[0], "r");
    char address[200] = {};
    if (std::fscanf(output, "listening %199s", address) != 1) throw std::runtime_error("it does not listen");
    std::fclose(output);
    address_ = address;
  }
  ExternalSolid(const ExternalSolid&) = delete;
  ExternalSolid& operator=(const ExternalSolid&) = delete;
  ~ExternalSolid() {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }

  std::unique_ptr<wire::Channel> connect() const { return wire::connect_zeromq(address_, {}); }
  int exit_code() {
    int status = 0;
    waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_ = -1;
  std::string address_;
};

constexpr double mass = 2, stiffness = 50;  // [kg], [N/m] of the external program

surface::FieldSet force(double value) {
  return {{"force", "N", surface::NodeArray::Constant(4, 3, value)}};
}

double displacement(const participant::StepSolved& solved) {
  return solved.fields.at(0).values(3, 1);
}

TEST(ExternalSolid, TakesPartInAWholeSessionAndGivesTheClosedForm) {
  const auto checkpoint = std::filesystem::temp_directory_path() / ("external_" + std::to_string(getpid()) + ".npy");
  const double w = std::sqrt(stiffness / mass), step = 0.05;
  const auto exact = [&](double t) { return 10 / stiffness * (1 - std::cos(w * t)); };
  {
    ExternalSolid solid;
    participant::RemoteParticipant remote(solid.connect(), {"solid", "test"});
    const auto opened = remote.open({});
    EXPECT_EQ(opened.surface.n_faces(), 1);
    EXPECT_EQ(opened.surface.region.at(0), "top");
    EXPECT_EQ(opened.surface.node_position(opened.surface.marker.at("corner"), 1), 1);
    for (int i = 1; i <= 20; ++i) {
      const double t = (i - 1) * step;
      // Coupling iterations with other loads and other durations leave no trace: every one starts from the accepted
      // state.
      remote.solve_step({i, 1, t, step}, force(-3));
      remote.solve_step({i, 2, t, step / 2}, force(10));
      const auto solved = remote.solve_step({i, 3, t, step}, force(10));
      // Twenty exact steps: only rounding remains, some 1e-16 of 0.4 m a step.
      EXPECT_NEAR(displacement(solved), exact(i * step), 1e-14);
      remote.accept_step(i);
    }
    EXPECT_GT(remote.write_checkpoint(checkpoint.string()), 0U);
    EXPECT_GT(remote.close("finished").at(0).value, 0);
    EXPECT_EQ(solid.exit_code(), 0);
  }
  ExternalSolid solid;
  participant::RemoteParticipant remote(solid.connect(), {"solid", "test"});
  participant::OpenRequest request;
  request.resume_from = checkpoint.string();
  remote.open(request);
  EXPECT_NEAR(displacement(remote.solve_step({21, 1, 20 * step, step}, force(10))), exact(21 * step), 1e-14);
  remote.close("finished");
  std::filesystem::remove(checkpoint);
}

TEST(ExternalSolid, AnswersARepeatedRequestByTheSameBytes) {
  ExternalSolid solid;
  const auto channel = solid.connect();
  std::uint64_t sequence = 0;
  const auto ask = [&](v1::Request request, const surface::FieldSet& fields = {}) {
    request.set_sequence(sequence);
    channel->send(wire::encode_request(std::move(request), fields, nullptr));
    return std::move(channel->receive(wire::deadline_in(30)).value());
  };
  v1::Request hello, open, solve, accept;
  hello.mutable_hello()->set_protocol(wire::protocol_version);
  open.mutable_open_scene();
  solve.mutable_solve_step()->set_duration(0.1);
  accept.mutable_accept_step()->set_step(1);
  ++sequence, ask(hello);
  ++sequence, ask(open);
  ++sequence;
  const auto first = ask(solve, force(10)), again = ask(solve, force(10));
  ASSERT_EQ(first.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(first[i].text(), again[i].text());
  // Accepting twice by the same number moves the state once: one more step ends at twice the time.
  ++sequence, ask(accept), ask(accept);
  ++sequence;
  const auto frames = ask(solve, force(10));
  const auto arrays = wire::decode_arrays(wire::decode_reply(frames, "solid"), frames, "solid");
  const double w = std::sqrt(stiffness / mass);
  EXPECT_NEAR(arrays.fields.at(0).values(0, 0), 10 / stiffness * (1 - std::cos(0.2 * w)), 1e-15);
}

}  // namespace

}  // namespace couplet
