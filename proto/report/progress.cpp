#include "proto/report/progress.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace couplet::report {

namespace {

using Clock = std::chrono::steady_clock;

// Share of the newest measurement in the speed that is shown: calm, but it follows within some prints.
constexpr double newest_share = 0.2;

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// 42 s, 3 min 5 s, 2 h 10 min, 5 days
std::string duration_text(double seconds) {
  if (seconds < 59.5) return formatted("%.0f s", seconds);
  if (seconds < 3570)
    return formatted("%.0f min", std::floor(seconds / 60)) + formatted(" %.0f s", std::fmod(seconds, 60));
  if (seconds < 172800)
    return formatted("%.0f h", std::floor(seconds / 3600)) +
           formatted(" %.0f min", std::floor(std::fmod(seconds, 3600) / 60));
  return formatted("%.0f days", seconds / 86400);
}

double smoothed(double before, double newest) {
  return before > 0 ? (1 - newest_share) * before + newest_share * newest : newest;
}

std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string progress_text(const ProgressState& state) {
  std::string text =
      "step " + std::to_string(state.step) + formatted("  %.6g", state.time) + formatted(" of %g s", state.end_time);
  if (state.end_time > 0) text += formatted(" (%.0f%%)", std::floor(100 * state.time / state.end_time + 1e-9));
  if (state.iterations > 0)
    text += "  " + std::to_string(state.iterations) + (state.iterations == 1 ? " iteration" : " iterations");
  if (state.residual > 0) text += formatted("  residual %.2g", state.residual);
  if (state.steps_per_second > 0) text += formatted("  %.3g steps/s", state.steps_per_second);
  if (state.simulated_per_second > 0) {
    text += formatted("  %.2g s/s", state.simulated_per_second);
    const double left = (state.end_time - state.time) / state.simulated_per_second;
    if (left > 0) text += "  " + duration_text(left) + " left";
  }
  return text;
}

Progress::Progress(double start_time, double end_time, bool quiet)
    : quiet_(quiet),
      is_terminal_(isatty(STDERR_FILENO) == 1 || std::getenv("COUPLET_PROGRESS_UPDATES") != nullptr),
      printed_at_(Clock::now()),
      printed_time_(start_time) {
  state_.time = start_time;
  state_.end_time = end_time;
}

Progress::~Progress() {
  if (is_line_open_) std::fputc('\n', stderr);
}

void Progress::step(std::int64_t step, double time, int iterations, double residual) {
  if (printed_step_ < 0) printed_step_ = step - 1;
  state_.step = step;
  state_.time = time;
  state_.iterations = iterations;
  state_.residual = residual;
  print_now_and_then();
}

void Progress::reach(double time) {
  state_.time = time;
  print_now_and_then();
}

void Progress::print_now_and_then() {
  if (quiet_) return;
  const auto now = Clock::now();
  const auto pause = is_terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10000);
  if (now - printed_at_ >= pause) print(now);
}

void Progress::print(Clock::time_point now) {
  const double seconds = std::chrono::duration<double>(now - printed_at_).count();
  if (seconds > 0 && state_.step > printed_step_)
    state_.steps_per_second =
        smoothed(state_.steps_per_second, static_cast<double>(state_.step - printed_step_) / seconds);
  if (seconds > 0 && state_.time > printed_time_)
    state_.simulated_per_second = smoothed(state_.simulated_per_second, (state_.time - printed_time_) / seconds);
  printed_at_ = now;
  printed_step_ = state_.step;
  printed_time_ = state_.time;
  std::string line = progress_text(state_);
  if (is_terminal_) {
    line.resize(std::min(line.size(), terminal_width() - 1));  // a wrapped line cannot be written over
    line = "\r" + line + "\x1b[K";
  } else {
    line += '\n';
  }
  std::fwrite(line.data(), 1, line.size(), stderr);
  is_line_open_ = is_terminal_;
}

void Progress::finish() {
  if (!quiet_ && state_.step > printed_step_ && printed_step_ >= 0) print(Clock::now());
  if (is_line_open_) std::fputc('\n', stderr);
  is_line_open_ = false;
}

}  // namespace couplet::report
