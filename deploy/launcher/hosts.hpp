#pragma once
// The file that says who runs where.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "couplet/v1/hosts.pb.h"
#include "deploy/launcher/launch_plan.hpp"

namespace couplet::launcher {

/// Reads and checks it as a scene is checked. Throws SceneError that holds every complaint, a line each, or FileError.
v1::Hosts read_hosts(const std::filesystem::path& path);

/// Ranks of the flow that the hosts have room for.
int n_slots(const v1::Hosts& hosts);

/// Whether a host is the machine that the launcher runs on.
bool is_this_machine(const std::string& host);

/// The number of a host in the network, as a server binds to it: `address` when it is given, else what its name stands
/// for. Throws SceneError when it stands for nothing.
std::string numeric_address(const std::string& host, const std::string& address);

/// A program of a plan, as it is started on its host by the remote shell; with its environment, in the launcher's own
/// working folder, and under an attendant that ends it when the connection breaks. On this machine it stays what it is.
ProgramStart through_remote_shell(const ProgramStart& start, const v1::Hosts& hosts, const std::string& couplet);

/// What starts Open MPI's own helpers on other hosts; empty where the remote shell is none that it could use.
std::string mpi_agent(const v1::Hosts& hosts);

/// The hosts of the next attempt: each that `answers` denies is replaced by the first spare one that answers. `tell`
/// hears of each. Throws PeerError when there are not enough.
v1::Hosts replace_lost(v1::Hosts hosts, const std::function<bool(const std::string& host)>& answers,
                       const std::function<void(const std::string& sentence)>& tell);

/// Whether a command can be started there within ten seconds.
bool answers(const std::string& host, const v1::Hosts& hosts);

}  // namespace couplet::launcher
