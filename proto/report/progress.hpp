#pragma once
// One updating line on a terminal; without a terminal a line now and then.

#include <chrono>
#include <cstdint>
#include <string>

namespace couplet::report {

class Progress {
 public:
  Progress(double start_time, double end_time, bool quiet);
  /// After every accepted step; prints at most ten times a second on a terminal, every ten seconds elsewhere.
  void step(std::int64_t step, double time, int iterations, double residual);
  void finish();

 private:
  double start_time_, end_time_;
  bool quiet_, is_terminal_;
  std::chrono::steady_clock::time_point started_, last_;
  bool line_open_ = false;
};

}  // namespace couplet::report
