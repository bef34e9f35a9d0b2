// Memory and ZeroMQ channels: the conformance suite, with both ends in threads of this process.

#include <unistd.h>

#include <exception>
#include <thread>
#include <tuple>

#include "proto/wire/memory_channel.hpp"
#include "proto/wire/zeromq_channel.hpp"
#include "tests/unit/proto/wire/channel_conformance.hpp"
#include "tests/unit/proto/wire/test_keys.hpp"

namespace couplet::wire {

namespace {

class TwoThreads : public TwoEnds {
 public:
  using Ends = std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>>;
  explicit TwoThreads(Ends ends) : ends_(std::move(ends)) {}

  void play(const Part& coupler, const Part& server) override {
    std::exception_ptr fault;
    std::thread other([&] {
      try {
        server(std::move(ends_.second));
      } catch (...) {
        fault = std::current_exception();
      }
    });
    try {
      coupler(std::move(ends_.first));
    } catch (const std::exception& own) {
      ADD_FAILURE() << "coupler's part: " << own.what();
    }
    other.join();
    try {
      if (fault) std::rethrow_exception(fault);
    } catch (const std::exception& its) {
      ADD_FAILURE() << "server's part: " << its.what();
    }
  }

 private:
  Ends ends_;
};

ChannelKind memory() {
  return {"memory", [] { return std::make_unique<TwoThreads>(make_memory_channel()); }};
}

ChannelKind zeromq(const std::string& name, const std::string& address, bool is_encrypted = false) {
  return {name, [address, is_encrypted] {
            ZeromqOptions of_coupler, of_server;
            if (is_encrypted) std::tie(of_coupler.keys, of_server.keys) = make_keys_of_both();
            auto server = listen_zeromq(address, of_server);
            auto coupler = connect_zeromq(server->describe(), of_coupler);
            return std::make_unique<TwoThreads>(TwoThreads::Ends{std::move(coupler), std::move(server)});
          }};
}

INSTANTIATE_TEST_SUITE_P(Channels, ChannelConformance,
                         testing::Values(memory(), zeromq("zeromq_tcp", "tcp://127.0.0.1:*"),
                                         zeromq("zeromq_tcp_encrypted", "tcp://127.0.0.1:*", true),
                                         zeromq("zeromq_ipc", "ipc://*"),
                                         zeromq("zeromq_ipc_abstract", "ipc://@couplet-" + std::to_string(getpid()))),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace

}  // namespace couplet::wire
