#include "solid-server/dynamics/work_team.hpp"

namespace couplet::solid {

WorkTeam::WorkTeam(int n_members) {
  for (int member = 1; member < n_members; ++member) threads_.emplace_back([this, member] { serve(member); });
}

WorkTeam::~WorkTeam() {
  is_ending_ = true;
  ++job_number_;
  job_number_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkTeam::run(const std::function<void(int)>& job) {
  if (threads_.empty()) {
    job(0);
    return;
  }
  job_ = &job;
  ++job_number_;
  job_number_.notify_all();
  job(0);
  barrier();
}

void WorkTeam::serve(int member) {
  for (unsigned seen = 0;;) {
    job_number_.wait(seen);
    seen = job_number_;
    if (is_ending_) return;
    (*job_)(member);
    barrier();
  }
}

void WorkTeam::barrier() {
  if (threads_.empty()) return;
  const unsigned number = barrier_number_.load();
  if (n_arrived_.fetch_add(1) + 1 == n_members()) {
    n_arrived_ = 0;
    ++barrier_number_;
    return;
  }
  constexpr int n_looks_awake = 2000;  // some ten microseconds: longer than members differ when each has a core
  for (int look = 0; barrier_number_.load() == number; ++look)
    if (look > n_looks_awake) std::this_thread::yield();
}

}  // namespace couplet::solid
