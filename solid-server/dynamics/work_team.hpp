#pragma once
// Threads that work on one job together and wait for each other at barriers inside it.

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace couplet::solid {

/// The caller is member 0; the others sleep between jobs, so that they take no core from the other programs of a run.
/// With one member nothing is started and a barrier costs nothing.
class WorkTeam {
 public:
  explicit WorkTeam(int n_members);
  ~WorkTeam();
  WorkTeam(const WorkTeam&) = delete;
  WorkTeam& operator=(const WorkTeam&) = delete;

  int n_members() const { return static_cast<int>(threads_.size()) + 1; }

  /// Calls job(member) on every member and returns when all are done. The job must not throw.
  void run(const std::function<void(int)>& job);

  /// Inside a job: returns when every member has come here. Waits awake for a moment, then lets others have the core.
  void barrier();

 private:
  void serve(int member);

  const std::function<void(int)>* job_ = nullptr;
  std::atomic<unsigned> job_number_{0};
  std::atomic<bool> is_ending_{false};
  std::atomic<int> n_arrived_{0};
  std::atomic<unsigned> barrier_number_{0};
  std::vector<std::thread> threads_;
};

/// The share [first, last) of n things that a member works on.
struct Share {
  int first, last;
};
inline Share share_of(int n, int member, int n_members) {
  const auto part = [&](int m) { return static_cast<int>(static_cast<long>(n) * m / n_members); };
  return {part(member), part(member + 1)};
}

}  // namespace couplet::solid
