// Started on 2 and 4 ranks.
#include "flow-server/service/rank_relay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

using ::testing::ElementsAre;

int rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int n_ranks() {
  int n = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

/// Writes down what it is asked; every answer is a sum over ranks, so that a rank that does not follow would be missed.
class Notes : public participant::Participant {
 public:
  participant::Opened open(const participant::OpenRequest& request) override {
    calls.push_back("open " + request.scene.title() + " in " + request.scene_folder + " for " + request.run_folder +
                    " from " + request.resume_from);
    participant::Opened opened;
    opened.time = sum(1);
    return opened;
  }
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override {
    calls.push_back("solve " + std::to_string(interval.step));
    participant::StepSolved solved;
    solved.residual = sum(interval.start + interval.duration + fields.at(0).values(1, 2));
    return solved;
  }
  std::vector<participant::NamedNumber> accept_step(std::int64_t step) override {
    calls.push_back("accept " + std::to_string(step));
    return {{"sum", sum(rank()), "1"}};
  }
  std::uint64_t write_checkpoint(const std::string& path) override {
    calls.push_back("write " + path);
    return static_cast<std::uint64_t>(sum(10));
  }
  std::vector<participant::NamedNumber> close(const std::string& reason) override {
    calls.push_back("close " + reason);
    return {};
  }

  std::vector<std::string> calls;

 private:
  static double sum(double value) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    return value;
  }
};

surface::FieldSet motion() {
  surface::NodeArray values = surface::NodeArray::Zero(3, 3);
  values(1, 2) = 0.5;
  return {{"displacement", "m", values}};
}

TEST(RankRelay, EveryRankFollowsEveryCall) {
  auto own = std::make_unique<Notes>();
  Notes& notes = *own;
  Notes follower;
  const int n = n_ranks();
  if (rank() > 0) {
    follow_calls(follower, MPI_COMM_WORLD);
    EXPECT_THAT(follower.calls, ElementsAre("open a title in /scene for /run from /old.h5", "solve 3", "accept 3",
                                            "write /new.h5", "close done"));
    return;
  }
  RelayedParticipant relayed(std::move(own), MPI_COMM_WORLD);
  participant::OpenRequest request;
  request.scene.set_title("a title");
  request.scene_folder = "/scene";
  request.run_folder = "/run";
  request.resume_from = "/old.h5";
  EXPECT_EQ(relayed.open(request).time, n);
  EXPECT_EQ(relayed.solve_step({3, 1, 2.0, 0.25}, motion()).residual, n * 2.75);
  EXPECT_EQ(relayed.accept_step(3).at(0).value, 0.5 * n * (n - 1));
  EXPECT_EQ(relayed.write_checkpoint("/new.h5"), 10u * static_cast<unsigned>(n));
  relayed.close("done");
  EXPECT_EQ(notes.calls.size(), 5u);
}

/// All ranks fail in the same place, as collective numerics do.
class AllFail : public Notes {
 public:
  std::vector<participant::NamedNumber> accept_step(std::int64_t) override {
    throw report::FileError("flow.h5", "the disk is full", "free some space");
  }
};

TEST(RankRelay, FailureOfAllIsThrownOnce) {
  if (rank() > 0) {
    AllFail follower;
    follow_calls(follower, MPI_COMM_WORLD);
    EXPECT_THAT(follower.calls, ElementsAre("close failed"));
    return;
  }
  RelayedParticipant relayed(std::make_unique<AllFail>(), MPI_COMM_WORLD);
  EXPECT_THROW(relayed.accept_step(1), report::FileError);
  EXPECT_NO_THROW(relayed.close("failed"));
}

/// Fails on the last rank only, where nobody waits for it.
class LastFails : public Notes {
 public:
  std::uint64_t write_checkpoint(const std::string&) override {
    if (rank() == n_ranks() - 1) throw report::NumericsError("cell 7", "is not a number", "take smaller steps");
    return 0;
  }
};

TEST(RankRelay, FailureOfAnotherRankIsThrownOnTheFirst) {
  if (rank() > 0) {
    LastFails follower;
    follow_calls(follower, MPI_COMM_WORLD);
    return;
  }
  RelayedParticipant relayed(std::make_unique<LastFails>(), MPI_COMM_WORLD);
  try {
    relayed.write_checkpoint("/file");
    FAIL() << "was not thrown";
  } catch (const report::NumericsError& error) {
    EXPECT_STREQ(error.what(), "cell 7: is not a number; take smaller steps");
  }
  EXPECT_NO_THROW(relayed.close("failed"));
}

TEST(RankRelay, LetsTheOthersGoWithoutAnyCall) {
  if (rank() > 0) {
    Notes follower;
    follow_calls(follower, MPI_COMM_WORLD);
    EXPECT_TRUE(follower.calls.empty());
  } else {
    const RelayedParticipant relayed(std::make_unique<Notes>(), MPI_COMM_WORLD);
  }
}

}  // namespace
}  // namespace couplet::flow
