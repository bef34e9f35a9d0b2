#pragma once
// The command line that every server has: serve, run, check. A server adds its participant and further verbs.

#include <mpi.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "proto/participant/participant.hpp"

namespace couplet::participant {

struct ServerOptions {
  int threads = 0;  // 0: all cores of this machine
  /// The processes of this program, for its numerics; MPI_COMM_NULL: MPI was not started, this process is the only one.
  MPI_Comm ranks = MPI_COMM_NULL;
};

/// Something else that a server can do with a scene, besides running it: NAME SCENE [--out DIR] [--set ...].
struct SceneVerb {
  std::string name, purpose;
  std::function<void(const OpenRequest&, const ServerOptions&)> work;  // run_folder: the folder of --out, or empty
};

struct ServerProgram {
  std::string name;     // "flow-server"
  std::string purpose;  // one sentence for --help
  /// On rank 0, which alone talks to others and owns the files of a run.
  std::function<std::unique_ptr<Participant>(const ServerOptions&)> make_participant;
  /// What the other ranks do at the same time: they follow that participant's calls to its end. Not set: the program
  /// works on one rank and starts MPI only when it is asked for.
  std::function<void(const ServerOptions&)> follow;
  /// What a run of this scene would need: cells or degrees of freedom, memory, stable time step, cost. For `check`.
  std::function<std::vector<NamedNumber>(const OpenRequest&)> estimate;
  std::vector<SceneVerb> verbs;
};

/// serve --listen ADDRESS [SCENE]   binds there, prints `listening ADDRESS`, serves one session, ends
/// serve --transport mpi            the same inside one MPI job
/// Under mpirun a program that can follow uses all ranks.
/// run SCENE --out DIR [--set PATH=VALUE]... [--steps N] [--resume DIR] [--quiet]   alone, against prescribed loads
/// check SCENE [--set PATH=VALUE]... [--json]   prints the estimate
/// Returns the exit code; may throw report::Failure.
int run_server_program(const ServerProgram& program, int argc, char** argv);

}  // namespace couplet::participant
