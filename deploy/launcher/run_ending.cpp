#include "deploy/launcher/run_ending.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <functional>
#include <optional>

namespace couplet::launcher {
namespace {

constexpr int lost_program = 4, bug = 70;
constexpr int lost_connection = 255;  // what ssh and its like end with when they lose a host

/// The signal that ended a program, also behind a code above 128 as mpirun and shells report it; 0: none.
int ending_signal(const ProgramEnding& end) {
  if (end.ending.by_signal) return end.ending.code;
  return end.ending.code > 128 && end.ending.code < 128 + 65 ? end.ending.code - 128 : 0;
}

/// The first program of which it holds, among those that ended unasked.
const ProgramEnding* find(const RunEnding& run, const std::function<bool(const ProgramEnding&)>& holds) {
  const auto found = std::find_if(run.endings.begin(), run.endings.end(), [&](const ProgramEnding& end) {
    const bool was_asked = end.was_asked || (run.stop_requested && ending_signal(end) == SIGTERM);
    return !was_asked && holds(end);
  });
  return found == run.endings.end() ? nullptr : &*found;
}

Verdict killed(const ProgramEnding& end) {
  const int signal = ending_signal(end);
  const std::string who = end.program == "mpirun" ? "a program of the MPI job" : end.program;
  const std::string how = " (signal " + std::to_string(signal) + ", " + strsignal(signal) + ")";
  constexpr std::array faults{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  if (std::find(faults.begin(), faults.end(), signal) != faults.end()) {
    if (end.is_own) return {lost_program, who + " crashed" + how + "; log.txt holds what it said", true};
    return {bug, who + " crashed" + how + "; this is a fault of Couplet: please report it with log.txt and the scene",
            true};
  }
  return {lost_program,
          who + " was killed" + how +
              "; what was written stays readable: run again, or continue from a checkpoint with --resume",
          true};
}

Verdict parted(const ProgramEnding& end) {
  return {lost_program,
          "the connection to the host of " + end.program +
              " was lost; what was written stays readable: run again, or continue from a checkpoint with --resume",
          true};
}

/// What Couplet does not know may end with any code.
Verdict of_own_program(const ProgramEnding& end) {
  constexpr std::array promised{2, 3, lost_program, 5, bug};
  const int code = end.ending.code;
  const bool known = std::find(promised.begin(), promised.end(), code) != promised.end();
  const std::string words = end.last_words.empty() ? "; log.txt holds what it said" : ": " + end.last_words;
  return {known ? code : lost_program, end.program + " ended with code " + std::to_string(code) + words,
          code == lost_program};
}

Verdict in_its_own_words(const ProgramEnding& end) {
  if (end.is_own) return of_own_program(end);
  const bool known = end.ending.code == 2 || end.ending.code == 3 || end.ending.code == 4 || end.ending.code == 5;
  const std::string words = end.last_words.empty() ? end.program + " ended with code " +
                                                         std::to_string(end.ending.code) + "; log.txt says more"
                                                   : end.last_words;
  return {known ? end.ending.code : bug, words, end.ending.code == lost_program};
}

}  // namespace

Verdict judge(const RunEnding& run) {
  if (const auto* end = find(run, [](const auto& e) { return ending_signal(e) != 0; })) return killed(*end);
  if (const auto* end = find(run, [](const auto& e) { return e.ending.code == lost_connection; })) return parted(*end);
  const auto failed = [](const ProgramEnding& e) { return e.ending.code != 0 && e.ending.code != lost_program; };
  if (const auto* end = find(run, [&](const auto& e) { return e.is_leader && failed(e); }))
    return in_its_own_words(*end);
  if (const auto* end = find(run, failed)) return in_its_own_words(*end);
  if (!run.stuck.empty()) {
    return {lost_program,
            run.stuck + "; what was written stays readable: run again, or continue from a checkpoint with --resume",
            true};
  }
  if (const auto* end = find(run, [](const auto& e) { return e.is_leader && e.ending.code != 0; }))
    return in_its_own_words(*end);
  if (const auto* end = find(run, [](const auto& e) { return e.ending.code != 0; })) return in_its_own_words(*end);
  return {};
}

}  // namespace couplet::launcher
