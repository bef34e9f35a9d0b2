#pragma once
// A channel between two programs of one MPI job.

#include <mpi.h>

#include <memory>
#include <string>

#include "proto/wire/channel.hpp"

namespace couplet::wire {

struct MpiOptions {
  double heartbeat_deadline = 8;  // [s] a peer without sign of life for this time is lost
};

/// Between this process and rank 0 of the other group. The intercommunicator carries nothing else and stays with MPI
/// until the job ends: giving it back would need the other group, which may be dead. `peer` names the other program for
/// people.
std::unique_ptr<Channel> make_mpi_channel(MPI_Comm intercommunicator, const std::string& peer,
                                          const MpiOptions& options);

}  // namespace couplet::wire
