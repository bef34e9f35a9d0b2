#include "proto/wire/mpi_heartbeat.hpp"

#include <algorithm>
#include <chrono>

#include "proto/wire/mpi_tags.hpp"

namespace couplet::wire {

MpiHeartbeat::MpiHeartbeat(MPI_Comm intercommunicator, double deadline)
    : intercommunicator_(intercommunicator), thread_([this, deadline] { beat_until_told(deadline); }) {}

MpiHeartbeat::~MpiHeartbeat() {
  {
    const std::scoped_lock lock(mutex_);
    should_end_ = true;
  }
  told_.notify_all();
  thread_.join();
}

void MpiHeartbeat::beat_until_told(double deadline) {
  const std::chrono::duration<double> interval(std::min(1.0, deadline / 8));
  // Silence is counted in own beats, not by the clock: whoever was asleep itself must not blame the other one.
  const int silent_limit = static_cast<int>(0.75 * deadline / interval.count());
  int silent = 0;
  std::unique_lock lock(mutex_);
  while (!should_end_) {
    MPI_Request request;
    MPI_Isend(nullptr, 0, MPI_BYTE, 0, mpi_beat_tag, intercommunicator_, &request);
    MPI_Request_free(&request);
    silent = hear() ? 0 : silent + 1;
    if (silent > silent_limit) is_lost_ = true;
    told_.wait_for(lock, interval, [&] { return should_end_; });
  }
}

bool MpiHeartbeat::hear() const {
  bool has_heard = false;
  while (true) {
    int is_there = 0;
    MPI_Message message;
    MPI_Improbe(0, mpi_beat_tag, intercommunicator_, &is_there, &message, MPI_STATUS_IGNORE);
    if (is_there == 0) return has_heard;
    MPI_Mrecv(nullptr, 0, MPI_BYTE, &message, MPI_STATUS_IGNORE);
    has_heard = true;
  }
}

}  // namespace couplet::wire
