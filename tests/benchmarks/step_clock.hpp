#pragma once
// How long a piece of work takes on all ranks.

#include <mpi.h>

#include <ctime>

namespace couplet::benchmark {

/// Wall time, or processor time of the busiest rank, which other programs on the machine disturb less. Waiting for
/// other ranks inside the work counts in both.
class StepClock {
 public:
  explicit StepClock(bool counts_processor) : counts_processor_(counts_processor) {}

  /// Collective. Seconds from all ranks being there to the last one being through.
  template <class Work>
  double seconds(const Work& work) const {
    MPI_Barrier(MPI_COMM_WORLD);
    const double started = now();
    work();
    double taken = now() - started;
    MPI_Allreduce(MPI_IN_PLACE, &taken, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    return taken;
  }

 private:
  double now() const {
    if (!counts_processor_) return MPI_Wtime();
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  bool counts_processor_;
};

}  // namespace couplet::benchmark
