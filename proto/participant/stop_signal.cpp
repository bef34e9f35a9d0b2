#include "proto/participant/stop_signal.hpp"

#include <csignal>

namespace couplet::participant {

namespace {

// A signal handler has no argument of ours, so this one flag must be global.
volatile std::sig_atomic_t stop_flag = 0;

void note_stop(int) {
  stop_flag = 1;
}

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = note_stop;
  action.sa_flags = SA_RESETHAND;  // the next one has its usual effect
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
}

bool stop_was_asked() {
  return stop_flag != 0;
}

}  // namespace couplet::participant
