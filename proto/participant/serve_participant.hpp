#pragma once
// The server's end of a session: requests in, calls to a Participant, replies out.

#include <functional>
#include <string>

#include "proto/participant/participant.hpp"
#include "proto/wire/channel.hpp"

namespace couplet::participant {

struct ServeOptions {
  std::string program;  // named in Welcome
  int ranks = 1;
  int threads = 1;
  std::string scene_folder;          // when not empty: relative paths start here and not where the coupler says
  std::function<bool()> should_end;  // asked between requests; true: results are completed and PeerError is thrown
};

/// Serves one session until it is closed. Refuses what session_rules refuse, answers a repeated sequence number by the
/// stored reply. A report::Failure of the participant is sent to the coupler as Failure and thrown again after the
/// close; a step that failed numerically may be tried again, and is thrown only when it was the last word. Throws
/// PeerError when the coupler is lost.
void serve_participant(wire::Channel& channel, Participant& participant, const ServeOptions& options);

}  // namespace couplet::participant
