#include "tests/unit/proto/wire/channel_conformance.hpp"

#include <cstdint>
#include <ctime>
#include <thread>

#include "proto/checksum/crc32c.hpp"
#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

using End = std::unique_ptr<Channel>;

constexpr double long_enough = 30;  // [s] for anything that must arrive, on a busy machine
constexpr std::size_t many = 1000;

Frames message_of(std::initializer_list<std::string_view> texts) {
  Frames message;
  for (const auto text : texts) message.push_back(Frame::copy_of(text));
  return message;
}

Frames receive_or_fail(Channel& channel) {
  auto message = channel.receive(deadline_in(long_enough));
  if (!message) throw std::runtime_error("nothing arrived");
  return std::move(*message);
}

// Sends each message back once.
void echo(Channel& channel, int n_messages) {
  for (int i = 0; i < n_messages; ++i) channel.send(receive_or_fail(channel));
}

Frame pattern(std::size_t size) {
  Frame frame(size);
  for (std::size_t i = 0; i < size; ++i) frame.data()[i] = static_cast<std::byte>(i * 2654435761U >> 13);
  return frame;
}

// Of the thread that asks: what other threads use says nothing of how it waits.
double processor_seconds() {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

}  // namespace

TEST_P(ChannelConformance, MessagesArriveInOrder) {
  play(
      [](const End& coupler) {
        for (int i = 0; i < 200; ++i) coupler->send(message_of({std::to_string(i)}));
        EXPECT_EQ(receive_or_fail(*coupler)[0].text(), "thanks");
      },
      [](const End& server) {
        for (int i = 0; i < 200; ++i) EXPECT_EQ(receive_or_fail(*server)[0].text(), std::to_string(i));
        server->send(message_of({"thanks"}));
      });
}

TEST_P(ChannelConformance, EmptyFramesKeepTheirPlaces) {
  play(
      [](const End& coupler) {
        coupler->send(message_of({"", "a", "", ""}));
        const Frames back = receive_or_fail(*coupler);
        ASSERT_EQ(back.size(), 4U);
        EXPECT_EQ(back[0].size(), 0U);
        EXPECT_EQ(back[1].text(), "a");
        EXPECT_EQ(back[3].size(), 0U);
      },
      [](const End& server) { echo(*server, 1); });
}

TEST_P(ChannelConformance, AMessageOfManyFramesIsWhole) {
  play(
      [](const End& coupler) {
        Frames message;
        for (std::size_t i = 0; i < many; ++i) message.push_back(Frame::copy_of(std::to_string(i)));
        coupler->send(std::move(message));
        const Frames back = receive_or_fail(*coupler);
        ASSERT_EQ(back.size(), many);
        for (std::size_t i = 0; i < many; ++i) EXPECT_EQ(back[i].text(), std::to_string(i));
      },
      [](const End& server) { echo(*server, 1); });
}

TEST_P(ChannelConformance, ALargeFrameArrivesUnchanged) {
  play(
      [](const End& coupler) {
        Frame large = pattern(20'000'000);
        const std::uint32_t sum = checksum::crc32c(large.data(), large.size());
        Frames message = message_of({"head"});
        message.push_back(std::move(large));
        coupler->send(std::move(message));
        const Frames back = receive_or_fail(*coupler);
        ASSERT_EQ(back.size(), 2U);
        ASSERT_EQ(back[1].size(), 20'000'000U);
        EXPECT_EQ(checksum::crc32c(back[1].data(), back[1].size()), sum);
      },
      [](const End& server) { echo(*server, 1); });
}

TEST_P(ChannelConformance, BothEndsMaySendLargeMessagesAtOnce) {
  const auto both = [](Channel& channel) {
    for (int i = 0; i < 3; ++i) {
      Frames message;
      message.push_back(pattern(5'000'000));
      channel.send(std::move(message));
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(receive_or_fail(channel)[0].size(), 5'000'000U);
  };
  play(
      [&](const End& coupler) {
        coupler->send(message_of({"begin"}));
        both(*coupler);
        coupler->send(message_of({"done"}));
        EXPECT_EQ(receive_or_fail(*coupler)[0].text(), "done");
      },
      [&](const End& server) {
        EXPECT_EQ(receive_or_fail(*server)[0].text(), "begin");
        both(*server);
        echo(*server, 1);
      });
}

TEST_P(ChannelConformance, ASharedMessageCanBeSentTwice) {
  play(
      [](const End& coupler) {
        Frames message = message_of({"twice"});
        message.push_back(pattern(100'000));
        coupler->send(share(message));
        coupler->send(std::move(message));
        for (int i = 0; i < 2; ++i) {
          const Frames back = receive_or_fail(*coupler);
          ASSERT_EQ(back.size(), 2U);
          EXPECT_EQ(back[0].text(), "twice");
          EXPECT_EQ(back[1].text(), pattern(100'000).text());
        }
      },
      [](const End& server) { echo(*server, 2); });
}

TEST_P(ChannelConformance, NothingUntilTheDeadlineMeansNothing) {
  play(
      [](const End& coupler) {
        coupler->send(message_of({"are you there"}));
        receive_or_fail(*coupler);
        const auto before = std::chrono::steady_clock::now();
        EXPECT_FALSE(coupler->receive(deadline_in(0.1)).has_value());
        EXPECT_GE(std::chrono::steady_clock::now() - before, std::chrono::milliseconds(100));
        EXPECT_FALSE(coupler->receive(deadline_in(-1)).has_value());
        coupler->send(message_of({"go on"}));
        EXPECT_EQ(receive_or_fail(*coupler)[0].text(), "go on");
      },
      [](const End& server) { echo(*server, 2); });
}

TEST_P(ChannelConformance, ALostServerIsNoticedAfterItsLastMessage) {
  play(
      [](const End& coupler) {
        coupler->send(message_of({"last"}));
        EXPECT_EQ(receive_or_fail(*coupler)[0].text(), "last");
        EXPECT_THROW(coupler->receive(deadline_in(long_enough)), report::PeerError);
        EXPECT_THROW(coupler->send(message_of({"anybody"})), report::PeerError);
      },
      [](End server) {
        echo(*server, 1);
        server.reset();
      });
}

TEST_P(ChannelConformance, ALostCouplerIsNoticedByAnIdleServer) {
  play(
      [](End coupler) {
        coupler->send(message_of({"last"}));
        EXPECT_EQ(receive_or_fail(*coupler)[0].text(), "last");
        coupler.reset();
      },
      [](const End& server) {
        echo(*server, 1);
        EXPECT_THROW(server->receive(deadline_in(long_enough)), report::PeerError);
      });
}

// Both ends wait for one second. Spinning would use all of it; sleeping takes a few milliseconds, more where the host
// of a virtual machine has other work. The bound lies in the middle.
TEST_P(ChannelConformance, WaitingLeavesTheProcessorToOthers) {
  const auto wait = [](Channel& channel) {
    const double before = processor_seconds();
    EXPECT_FALSE(channel.receive(deadline_in(1)).has_value());
    EXPECT_LT(processor_seconds() - before, 0.5);
  };
  play(
      [&](const End& coupler) {
        coupler->send(message_of({"wait"}));
        receive_or_fail(*coupler);
        wait(*coupler);
        coupler->send(message_of({"end"}));
        receive_or_fail(*coupler);
      },
      [&](const End& server) {
        echo(*server, 1);
        std::this_thread::sleep_for(std::chrono::milliseconds(900));
        echo(*server, 1);
      });
}

}  // namespace couplet::wire
