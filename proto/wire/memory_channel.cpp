#include "proto/wire/memory_channel.hpp"

#include <array>
#include <condition_variable>
#include <deque>
#include <mutex>

#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

// What both ends see; queue[i] holds the messages for end i.
struct Link {
  std::mutex mutex;
  std::condition_variable changed;
  std::array<std::deque<Frames>, 2> queue;
  std::array<bool, 2> is_open = {true, true};
};

class MemoryChannel : public Channel {
 public:
  // shared_ptr: neither end knows which of them lives longer.
  MemoryChannel(std::shared_ptr<Link> link, std::size_t end) : link_(std::move(link)), me_(end), peer_(1 - end) {}
  ~MemoryChannel() override {
    const std::scoped_lock lock(link_->mutex);
    link_->is_open[me_] = false;
    link_->changed.notify_all();
  }

  void send(Frames message) override {
    const std::scoped_lock lock(link_->mutex);
    if (!link_->is_open[peer_]) throw lost();
    link_->queue[peer_].push_back(std::move(message));
    link_->changed.notify_all();
  }

  std::optional<Frames> receive(Deadline deadline) override {
    std::unique_lock lock(link_->mutex);
    auto& queue = link_->queue[me_];
    link_->changed.wait_until(lock, deadline, [&] { return !queue.empty() || !link_->is_open[peer_]; });
    if (!queue.empty()) {
      Frames message = std::move(queue.front());
      queue.pop_front();
      return message;
    }
    if (!link_->is_open[peer_]) throw lost();
    return std::nullopt;
  }

  std::string describe() const override { return "memory"; }

 private:
  static report::PeerError lost() { return {"memory", "the other end of the channel was closed", ""}; }

  std::shared_ptr<Link> link_;
  std::size_t me_, peer_;
};

}  // namespace

std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>> make_memory_channel() {
  const auto link = std::make_shared<Link>();
  return {std::make_unique<MemoryChannel>(link, 0), std::make_unique<MemoryChannel>(link, 1)};
}

}  // namespace couplet::wire
