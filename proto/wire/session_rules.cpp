#include "proto/wire/session_rules.hpp"

#include <algorithm>
#include <array>

namespace couplet::wire {

namespace {

using State = SessionState;
using Request = v1::Request;

// The table of proto/README.md, row by row.
constexpr std::array table{
    SessionRule{State::connected, Request::kHello, State::greeted},
    SessionRule{State::connected, Request::kClose, State::closed},
    SessionRule{State::greeted, Request::kOpenScene, State::opened},
    SessionRule{State::greeted, Request::kClose, State::closed},
    SessionRule{State::opened, Request::kSolveStep, State::solved},
    SessionRule{State::opened, Request::kClose, State::closed},
    SessionRule{State::solved, Request::kSolveStep, State::solved},
    SessionRule{State::solved, Request::kAcceptStep, State::accepted},
    SessionRule{State::solved, Request::kClose, State::closed},
    SessionRule{State::accepted, Request::kSolveStep, State::solved},
    SessionRule{State::accepted, Request::kWriteCheckpoint, State::accepted},
    SessionRule{State::accepted, Request::kClose, State::closed},
    SessionRule{State::failed, Request::kClose, State::closed},
};

}  // namespace

std::string name(SessionState state) {
  switch (state) {
    case State::connected:
      return "connected";
    case State::greeted:
      return "greeted";
    case State::opened:
      return "opened";
    case State::solved:
      return "solved";
    case State::accepted:
      return "accepted";
    case State::failed:
      return "failed";
    case State::closed:
      return "closed";
  }
  return "unknown";
}

std::string name(v1::Request::BodyCase request) {
  switch (request) {
    case Request::kHello:
      return "hello";
    case Request::kOpenScene:
      return "open-scene";
    case Request::kSolveStep:
      return "solve-step";
    case Request::kAcceptStep:
      return "accept-step";
    case Request::kWriteCheckpoint:
      return "write-checkpoint";
    case Request::kClose:
      return "close";
    case Request::BODY_NOT_SET:
      break;
  }
  return "nothing";
}

const SessionRule* find_rule(SessionState state, v1::Request::BodyCase request) {
  const auto* row = std::find_if(table.begin(), table.end(), [&](const SessionRule& rule) {
    return rule.state == state && rule.request == request;
  });
  return row == table.end() ? nullptr : row;
}

SequenceVerdict judge_sequence(std::uint64_t last, std::uint64_t sequence) {
  if (sequence == last + 1) return SequenceVerdict::next;
  if (sequence > last) return SequenceVerdict::skipped;
  // Before the first request there is nothing to repeat; a number 0 is then merely late.
  return sequence == last && last > 0 ? SequenceVerdict::repeated : SequenceVerdict::late;
}

}  // namespace couplet::wire
