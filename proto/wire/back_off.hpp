#pragma once
// Waiting for something that can only be asked for: quick at first, then with longer and longer sleeps.

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace couplet::wire {

/// A wait is made longer by at most an eighth, and a long one costs next to no processor time.
class BackOff {
 public:
  void pause() {
    using std::chrono::microseconds;
    const auto waited = std::chrono::steady_clock::now() - start_;
    if (waited < microseconds(50)) {
      sched_yield();
    } else {
      std::this_thread::sleep_for(std::min<std::chrono::steady_clock::duration>(waited / 8, microseconds(1000)));
    }
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace couplet::wire
