#pragma once
// Signs of life between two programs of one MPI job.

#include <mpi.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace couplet::wire {

/// A thread of its own sends and takes empty messages, so that a program that computes for minutes counts as alive and
/// one that is frozen does not. It sleeps in between; MPI must allow calls from several threads (MPI_THREAD_MULTIPLE).
class MpiHeartbeat {
 public:
  /// Watches rank 0 of the other group of an intercommunicator.
  MpiHeartbeat(MPI_Comm intercommunicator, double deadline);
  MpiHeartbeat(const MpiHeartbeat&) = delete;
  MpiHeartbeat& operator=(const MpiHeartbeat&) = delete;
  ~MpiHeartbeat();

  /// Nothing was heard for the deadline.
  bool is_lost() const { return is_lost_; }

 private:
  void beat_until_told(double deadline);
  bool hear() const;

  MPI_Comm intercommunicator_;
  std::atomic<bool> is_lost_ = false;
  std::mutex mutex_;
  std::condition_variable told_;
  bool should_end_ = false;
  std::thread thread_;
};

}  // namespace couplet::wire
