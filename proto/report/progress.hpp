#pragma once
// One updating line on a terminal; without a terminal a line now and then. Who reads a program's lines and shows them
// on a terminal sets COUPLET_PROGRESS_UPDATES in its environment to get the updating line.

#include <chrono>
#include <cstdint>
#include <string>

namespace couplet::report {

/// How far a run is, as a person reads it.
struct ProgressState {
  std::int64_t step = 0;
  double time = 0;                  // simulated [s]
  double end_time = 0;              // [s]
  int iterations = 0;               // of the last step; 0: not said
  double residual = 0;              // of the last step; 0: not said
  double steps_per_second = 0;      // 0: not known yet
  double simulated_per_second = 0;  // simulated seconds in a second of wall time
};

/// step 1200  0.012 of 0.6 s (2%)  5 iterations  residual 3.2e-06  812 steps/s  0.0081 s/s  1 min 13 s left
std::string progress_text(const ProgressState& state);

/// Writes to standard error.
class Progress {
 public:
  Progress(double start_time, double end_time, bool quiet);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  // ends the line

  /// After every accepted step; prints at most ten times a second on a terminal, every ten seconds elsewhere.
  void step(std::int64_t step, double time, int iterations, double residual);
  /// In the midst of a long step, likewise.
  void reach(double time);
  /// Prints the last step and ends the line.
  void finish();

 private:
  void print_now_and_then();
  void print(std::chrono::steady_clock::time_point now);

  ProgressState state_;
  bool quiet_, is_terminal_;
  std::chrono::steady_clock::time_point printed_at_;
  std::int64_t printed_step_ = -1;  // -1: no step seen yet
  double printed_time_;
  bool is_line_open_ = false;
};

}  // namespace couplet::report
