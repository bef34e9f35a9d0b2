#pragma once
// A channel carries messages between the coupler and one server: in order, complete or not at all.

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "proto/wire/frame.hpp"

namespace couplet::wire {

/// One message: frame 0 is a serialized Request or Reply, the others are raw arrays. It has at least one frame.
using Frames = std::vector<Frame>;

/// The same bytes once more, for a message that may have to be sent again.
inline Frames share(const Frames& message) {
  Frames shared;
  shared.reserve(message.size());
  for (const Frame& frame : message) shared.push_back(frame.share());
  return shared;
}

using Deadline = std::chrono::steady_clock::time_point;

/// That many seconds from now; a very long time from now when they are too many for the clock.
inline Deadline deadline_in(double seconds) {
  constexpr double longest = 1e9;  // [s]
  const std::chrono::duration<double> span(seconds < longest ? seconds : longest);
  return std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(span);
}

/// A message that claims to be larger than this is not accepted; it bounds the memory that a faulty peer can ask for.
inline constexpr std::size_t frame_count_limit = 4096;
inline constexpr std::size_t frame_size_limit = std::size_t{1} << 30;  // [bytes], 44 million nodes with 3 components

/// The two ends are alike. Waiting gives way to whoever has work, and sleeps when it takes long: a channel never spins
/// on a core that a solver needs. send and receive throw PeerError when the other end is known to be lost (closed,
/// killed, frozen beyond the heartbeat); messages that arrived before are still received first.
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
