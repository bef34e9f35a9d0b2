#pragma once
// The state table of a session (proto/README.md, "Session"), as the server keeps it.

#include <cstdint>
#include <string>

#include "couplet/v1/exchange.pb.h"

namespace couplet::wire {

/// Of Hello and Welcome; a program that speaks another one is refused.
inline constexpr std::uint32_t protocol_version = 1;

enum class SessionState {
  connected,  // waits for hello
  greeted,    // waits for open-scene
  opened,     // has an accepted state; no step yet, or the last one could not be solved
  solved,     // has a trial state
  accepted,   // has an accepted state, no trial state
  failed,     // only close is allowed
  closed,
};

std::string name(SessionState state);
std::string name(v1::Request::BodyCase request);

/// One row of the table: in `state` this request is allowed and, when it succeeds, leads to `next`.
struct SessionRule {
  SessionState state;
  v1::Request::BodyCase request;
  SessionState next;
};

/// The row for a request, or nullptr when it is not allowed in this state.
const SessionRule* find_rule(SessionState state, v1::Request::BodyCase request);

/// What the number of a request says about it.
enum class SequenceVerdict {
  next,      // to be served
  repeated,  // of the last request: the stored reply is sent again, nothing is computed
  late,      // older than that: refused, the session goes on
  skipped,   // a request in between is missing: refused, the session has failed
};

SequenceVerdict judge_sequence(std::uint64_t last, std::uint64_t sequence);

}  // namespace couplet::wire
