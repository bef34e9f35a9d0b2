#pragma once
// Waiting for something that can only be asked for: quick at first, then with longer and longer sleeps.

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace couplet::wire {

/// A long wait is made longer by at most an eighth and costs next to no processor time.
class BackOff {
 public:
  /// True while asking again at once is worth it. To fall asleep and to be woken takes about 100 us, which is as long
  /// as a small exchange; and MPI moves a large message on only while both ends ask.
  bool is_brisk() const { return waited() < std::chrono::microseconds(400); }

  void pause() {
    if (is_brisk()) {
      sched_yield();  // whoever has work goes first
    } else {
      std::this_thread::sleep_for(std::min<std::chrono::steady_clock::duration>(waited() / 8, longest_sleep));
    }
  }

 private:
  static constexpr std::chrono::milliseconds longest_sleep{1};

  std::chrono::steady_clock::duration waited() const { return std::chrono::steady_clock::now() - start_; }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace couplet::wire
