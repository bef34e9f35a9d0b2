#pragma once
// One MPI job in which the coupler and the servers are started together.

#include <mpi.h>

#include <functional>
#include <memory>
#include <string>

#include "proto/wire/mpi_channel.hpp"

namespace couplet::wire {

/// The part that a process plays. It comes from its program and its command line, never from MPI_APPNUM, which Slurm
/// sets to 0 for everybody.
enum class MpiRole { coupler = 0, flow = 1, solid = 2 };

struct MpiConnections {
  std::unique_ptr<Channel> flow, solid;  // on the coupler: to each server that the job has
  std::unique_ptr<Channel> coupler;      // on rank 0 of a server
  MPI_Comm group = MPI_COMM_NULL;  // the processes of this role; a program never uses MPI_COMM_WORLD for its own work
};

class MpiJob {
 public:
  /// Collective over all processes of the job: everybody says the own role. Throws SceneError when there is not exactly
  /// one coupler and at least one server.
  MpiConnections connect(MpiRole role, const MpiOptions& options);

  /// Collective over all processes of a job of one program: its processes, for its own work. The program that is the
  /// only one has nobody to connect to.
  MPI_Comm join_all();

  bool is_connected() const { return is_connected_; }

 private:
  bool is_connected_ = false;
};

/// Runs a program's body between MPI_Init and MPI_Finalize, with failures reported as by report::run_program; returns
/// the exit code. A process that ends well, or with a failure after an orderly session, waits (without using its core)
/// for the others before MPI ends. One that lost a peer, or failed before it was connected, ends the job by MPI_Abort
/// with its exit code.
int run_in_mpi(const std::string& program, const std::function<int(MpiJob&)>& body);

}  // namespace couplet::wire
