#pragma once
// A channel carries messages between the coupler and one server: in order, complete or not at all.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "proto/wire/frame.hpp"

namespace couplet::wire {

/// One message: frame 0 is a serialized Request or Reply, the others are raw arrays.
using Frames = std::vector<Frame>;

using Deadline = std::chrono::steady_clock::time_point;

/// The two ends are alike. A channel never spins on a core that a solver needs: waiting sleeps.
/// send and receive throw PeerError when the other end is known to be lost (closed, killed, frozen beyond the heartbeat).
class Channel {
 public:
  virtual ~Channel() = default;
  virtual void send(Frames message) = 0;
  /// The next message, or nothing when the deadline passes first.
  virtual std::optional<Frames> receive(Deadline deadline) = 0;
  /// For messages to people, for example "tcp://127.0.0.1:40001".
  virtual std::string describe() const = 0;
};

}  // namespace couplet::wire
