// The MPI channel: the conformance suite between two processes (mpirun -n 2), and what only it can get wrong.

#include <gtest/gtest.h>
#include <mpi.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "proto/report/failure.hpp"
#include "proto/wire/mpi_channel.hpp"
#include "tests/unit/proto/wire/channel_conformance.hpp"

namespace couplet::wire {

namespace {

int my_rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

// A fresh intercommunicator between rank 0 (coupler) and rank 1 (server) for every test.
MPI_Comm connect_ranks() {
  MPI_Comm alone, between;
  MPI_Comm_split(MPI_COMM_WORLD, my_rank(), 0, &alone);
  MPI_Intercomm_create(alone, 0, MPI_COMM_WORLD, 1 - my_rank(), 1, &between);
  return between;
}

class TwoProcesses : public TwoEnds {
 public:
  explicit TwoProcesses(double heartbeat) : heartbeat_(heartbeat) {}
  void play(const Part& coupler, const Part& server) override {
    const bool is_coupler = my_rank() == 0;
    auto channel = make_mpi_channel(connect_ranks(), is_coupler ? "solid" : "coupler", {heartbeat_});
    try {
      (is_coupler ? coupler : server)(std::move(channel));
    } catch (const std::exception& fault) {
      ADD_FAILURE() << (is_coupler ? "coupler's part: " : "server's part: ") << fault.what();
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }

 private:
  double heartbeat_;
};

INSTANTIATE_TEST_SUITE_P(Channels, ChannelConformance,
                         testing::Values(ChannelKind{"mpi", [] { return std::make_unique<TwoProcesses>(8); }}),
                         [](const auto& kind) { return kind.param.name; });

Frames message_of(std::string_view text) {
  Frames message;
  message.push_back(Frame::copy_of(text));
  return message;
}

TEST(MpiChannel, APeerThatComputesForLongerThanTheHeartbeatIsAlive) {
  TwoProcesses(1).play(
      [](const std::unique_ptr<Channel>& coupler) {
        coupler->send(message_of("compute"));
        EXPECT_EQ(coupler->receive(deadline_in(30)).value()[0].text(), "computed");
      },
      [](const std::unique_ptr<Channel>& server) {
        EXPECT_EQ(server->receive(deadline_in(30)).value()[0].text(), "compute");
        std::this_thread::sleep_for(std::chrono::seconds(3));
        server->send(message_of("computed"));
      });
}

// Whether the frozen peer is idle or in the midst of a computation makes no difference.
TEST(MpiChannel, AFrozenPeerIsLostWithinTheHeartbeatDeadline) {
  TwoProcesses(1).play(
      [](const std::unique_ptr<Channel>& coupler) {
        coupler->send(message_of("freeze"));
        const auto process = std::stoi(std::string(coupler->receive(deadline_in(30)).value()[0].text()));
        const auto before = std::chrono::steady_clock::now();
        EXPECT_THROW(coupler->receive(deadline_in(30)), report::PeerError);
        // The deadline is 1 s; the rest is for a loaded machine, and far from the 30 s of the receive.
        EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(10));
        kill(process, SIGCONT);
      },
      [](const std::unique_ptr<Channel>& server) {
        EXPECT_EQ(server->receive(deadline_in(30)).value()[0].text(), "freeze");
        server->send(message_of(std::to_string(getpid())));
        std::this_thread::sleep_for(std::chrono::milliseconds(300));  // until the message has left
        raise(SIGSTOP);
      });
}

}  // namespace

}  // namespace couplet::wire

int main(int argc, char** argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &provided);
  testing::InitGoogleTest(&argc, argv);
  const int code = RUN_ALL_TESTS();
  MPI_Finalize();
  return code;
}
