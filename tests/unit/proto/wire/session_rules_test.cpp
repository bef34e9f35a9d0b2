#include "proto/wire/session_rules.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace couplet::wire {

namespace {

using Request = v1::Request;

const std::vector<SessionState> states = {SessionState::connected, SessionState::greeted,  SessionState::opened,
                                          SessionState::solved,    SessionState::accepted, SessionState::failed,
                                          SessionState::closed};
const std::vector<Request::BodyCase> requests = {Request::kHello,      Request::kOpenScene,       Request::kSolveStep,
                                                 Request::kAcceptStep, Request::kWriteCheckpoint, Request::kClose};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream rest(line.substr(1));
  for (std::string cell; std::getline(rest, cell, '|');) {
    const auto first = cell.find_first_not_of(" `"), last = cell.find_last_not_of(" `");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

// The state table of proto/README.md: next state by state and request; refused requests are absent.
std::map<std::pair<std::string, std::string>, std::string> table_for_people() {
  std::ifstream readme(COUPLET_PROTOCOL_PAGE);
  std::map<std::pair<std::string, std::string>, std::string> table;
  std::vector<std::string> head;
  for (std::string line; std::getline(readme, line);) {
    if (line.rfind("| state", 0) == 0) {
      head = cells_of(line);
    } else if (!head.empty() && line.rfind("| `", 0) == 0) {
      const auto cells = cells_of(line);
      for (std::size_t i = 1; i < cells.size() && i < head.size(); ++i)
        if (!cells[i].empty()) table[{cells[0], head[i]}] = cells[i];
    } else if (!head.empty() && line.empty()) {
      break;
    }
  }
  return table;
}

TEST(SessionRules, AreThoseOfTheProtocolPageRowByRow) {
  const auto table = table_for_people();
  ASSERT_FALSE(table.empty()) << "no state table in " << COUPLET_PROTOCOL_PAGE;
  std::size_t n_allowed = 0;
  for (const auto state : states) {
    for (const auto request : requests) {
      const auto* rule = find_rule(state, request);
      const auto row = table.find({name(state), name(request)});
      EXPECT_EQ(rule != nullptr, row != table.end()) << name(request) << " in state " << name(state);
      if (rule != nullptr && row != table.end()) {
        EXPECT_EQ(name(rule->next), row->second);
      }
      n_allowed += rule != nullptr ? 1 : 0;
    }
  }
  EXPECT_EQ(n_allowed, table.size());
}

TEST(SessionRules, CloseIsAlwaysAllowedUntilItWasDone) {
  for (const auto state : states)
    EXPECT_EQ(find_rule(state, Request::kClose) != nullptr, state != SessionState::closed) << name(state);
}

TEST(SessionRules, AStepIsAcceptedOnlyAfterItWasSolved) {
  for (const auto state : states)
    EXPECT_EQ(find_rule(state, Request::kAcceptStep) != nullptr, state == SessionState::solved) << name(state);
}

TEST(SessionRules, NothingIsAllowedWithoutARequest) {
  for (const auto state : states) EXPECT_EQ(find_rule(state, Request::BODY_NOT_SET), nullptr);
}

TEST(SequenceNumbers, SayWhatToDoWithARequest) {
  EXPECT_EQ(judge_sequence(0, 1), SequenceVerdict::next);
  EXPECT_EQ(judge_sequence(4, 5), SequenceVerdict::next);
  EXPECT_EQ(judge_sequence(4, 4), SequenceVerdict::repeated);
  EXPECT_EQ(judge_sequence(4, 3), SequenceVerdict::late);
  EXPECT_EQ(judge_sequence(4, 0), SequenceVerdict::late);
  EXPECT_EQ(judge_sequence(4, 6), SequenceVerdict::skipped);
  EXPECT_EQ(judge_sequence(0, 0), SequenceVerdict::late);
}

}  // namespace

}  // namespace couplet::wire
