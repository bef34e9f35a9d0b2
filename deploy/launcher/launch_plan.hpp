#pragma once
// Which programs a scene needs, and with which arguments they are started. Nothing is started here.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "couplet/v1/hosts.pb.h"
#include "couplet/v1/scene.pb.h"
#include "deploy/launcher/installation.hpp"
#include "deploy/launcher/run_options.hpp"

namespace couplet::launcher {

struct ProgramStart {
  std::string name;  // flow-server, solid-server, coupler; mpirun for several processes in one job;
                     // solid "COMMAND" for a program of the user's own
  std::vector<std::string> command;
  std::map<std::string, std::string> environment;  // added to that of the launcher
  std::string address_option;  // of a server that is reached by a socket: the leader takes its address with this option
  std::string owner_of_time;   // in an MPI job: the program that ends a run in good order when it is asked to
  bool is_own = false;         // a program of the user's own
  std::string host = {};       // where it is to run; empty: on this machine
  bool is_attended = false;    // behind a remote shell: signals travel as words (attendant.hpp)
};

struct LaunchPlan {
  std::vector<ProgramStart> servers;  // started first; each says `listening ADDRESS`
  ProgramStart leader;                // its end is the end of the run
  std::string transport;              // zmq, mpi; empty for a program on its own
};

/// `options.flow_ranks` is the number that was chosen. `socket_folder` is where local sockets may be made. Without
/// hosts all programs run on this machine. Throws SceneError when scene, options and hosts contradict each other.
LaunchPlan plan_launch(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                       const std::filesystem::path& run_folder, const std::filesystem::path& socket_folder,
                       const std::optional<v1::Hosts>& hosts = {});

}  // namespace couplet::launcher
