#include "proto/wire/mpi_job.hpp"

#include <cstdio>
#include <vector>

#include "proto/report/failure.hpp"
#include "proto/wire/back_off.hpp"

namespace couplet::wire {

namespace {

// [s] that a program waits for the others to end as well: the coupler may have long tables to write.
constexpr double patience = 600, patience_after_failure = 60;

std::string name(MpiRole role) {
  switch (role) {
    case MpiRole::coupler:
      return "coupler";
    case MpiRole::flow:
      return "flow";
    case MpiRole::solid:
      return "solid";
  }
  return "unknown";
}

// The role of every process, by rank in the job.
std::vector<int> gather_roles(MpiRole role) {
  int n_processes = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &n_processes);
  std::vector<int> roles(static_cast<std::size_t>(n_processes));
  const int mine = static_cast<int>(role);
  MPI_Allgather(&mine, 1, MPI_INT, roles.data(), 1, MPI_INT, MPI_COMM_WORLD);
  return roles;
}

// The first process of a role, or -1.
int leader(const std::vector<int>& roles, MpiRole role) {
  for (std::size_t rank = 0; rank < roles.size(); ++rank)
    if (roles[rank] == static_cast<int>(role)) return static_cast<int>(rank);
  return -1;
}

void check_roles(const std::vector<int>& roles) {
  int n_couplers = 0;
  for (const int role : roles) n_couplers += role == static_cast<int>(MpiRole::coupler) ? 1 : 0;
  if (n_couplers == 1 && roles.size() > 1) return;
  throw report::SceneError(
      "MPI job", "has " + std::to_string(n_couplers) + " couplers among " + std::to_string(roles.size()) + " processes",
      "start one coupler and its servers by one command: mpirun -n 1 coupler run ... : -n 1 "
      "solid-server serve --transport mpi");
}

// Whether all processes of the job come to their end.
bool wait_for_all(double longest) {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  const Deadline until = deadline_in(longest);
  BackOff back_off;
  int is_done = 0;
  while (is_done == 0 && std::chrono::steady_clock::now() < until) {
    MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    if (is_done == 0) back_off.pause();
  }
  return is_done != 0;
}

}  // namespace

MpiConnections MpiJob::connect(MpiRole role, const MpiOptions& options) {
  const std::vector<int> roles = gather_roles(role);
  check_roles(roles);
  MpiConnections connections;
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_split(MPI_COMM_WORLD, static_cast<int>(role), rank, &connections.group);
  const int coupler = leader(roles, MpiRole::coupler);
  for (const MpiRole server : {MpiRole::flow, MpiRole::solid}) {
    const int server_leader = leader(roles, server);
    const bool is_coupler = role == MpiRole::coupler;
    if (server_leader < 0 || (!is_coupler && role != server)) continue;
    MPI_Comm intercommunicator;
    MPI_Intercomm_create(connections.group, 0, MPI_COMM_WORLD, is_coupler ? server_leader : coupler,
                         static_cast<int>(server), &intercommunicator);
    if (!is_coupler && rank != server_leader) continue;
    auto channel = make_mpi_channel(intercommunicator, is_coupler ? name(server) : "coupler", options);
    (!is_coupler               ? connections.coupler
     : server == MpiRole::flow ? connections.flow
                               : connections.solid) = std::move(channel);
  }
  is_connected_ = true;
  return connections;
}

MPI_Comm MpiJob::join_all() {
  MPI_Comm group;
  MPI_Comm_dup(MPI_COMM_WORLD, &group);
  is_connected_ = true;
  return group;
}

int run_in_mpi(const std::string& program, const std::function<int(MpiJob&)>& body) {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &provided);
  MpiJob job;
  const int code = report::run_program(
      program,
      [&](int, char**) {
        if (provided < MPI_THREAD_MULTIPLE)
          throw report::PeerError("MPI", "cannot be called from several threads", "use --transport zmq");
        return body(job);
      },
      0, nullptr);
  const bool others_must_hear = code == report::exit_code(report::FailureKind::peer) ||
                                code == report::exit_code(report::FailureKind::bug) || !job.is_connected();
  std::fflush(nullptr);
  if (others_must_hear && code != 0) MPI_Abort(MPI_COMM_WORLD, code);
  if (!wait_for_all(code == 0 ? patience : patience_after_failure))
    MPI_Abort(MPI_COMM_WORLD, code != 0 ? code : report::exit_code(report::FailureKind::peer));
  MPI_Finalize();
  return code;
}

}  // namespace couplet::wire
