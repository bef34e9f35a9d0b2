#include "deploy/launcher/launch_plan.hpp"

#include "deploy/launcher/hosts.hpp"
#include "deploy/launcher/own_program.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::launcher {
namespace {

using Words = std::vector<std::string>;

void add(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

Words scene_arguments(const RunOptions& options) {
  Words words{options.scene.string()};
  for (const std::string& setting : options.settings) add(words, {"--set", setting});
  return words;
}

/// What every program that owns the time loop is told.
Words run_arguments(const RunOptions& options, const std::filesystem::path& run_folder) {
  Words words = scene_arguments(options);
  add(words, {"--out", run_folder.string()});
  if (!options.resume.empty()) add(words, {"--resume", options.resume.string()});
  if (options.steps > 0) add(words, {"--steps", std::to_string(options.steps)});
  if (options.quiet) add(words, {"--quiet"});
  return words;
}

Words thread_arguments(const RunOptions& options) {
  return options.solid_threads > 0 ? Words{"--threads", std::to_string(options.solid_threads)} : Words{};
}

Words key_arguments(const RunOptions& options) {
  return options.keys.empty() ? Words{} : Words{"--keys", std::filesystem::absolute(options.keys).string()};
}

std::string choose_transport(const v1::Scene& scene, const RunOptions& options) {
  if (!options.transport.empty()) return options.transport;
  switch (scene.coupling().transport()) {
    case v1::ZEROMQ:
      return "zmq";
    case v1::MPI:
      return "mpi";
    case v1::MEMORY:
      break;
  }
  throw report::SceneError("coupling.transport", "MEMORY joins participants inside one program and cannot join three",
                           "choose ZEROMQ or MPI, or add --transport zmq");
}

ProgramStart alone(const std::string& name, Words extra, const RunOptions& options, const Installation& installation,
                   const std::filesystem::path& run_folder) {
  Words command{installation.program(name), "run"};
  add(command, run_arguments(options, run_folder));
  add(command, extra);
  return {name, command, {}, {}, {}};
}

std::string listen_address(const v1::Scene& scene, const std::filesystem::path& socket_folder,
                           const std::string& name) {
  return scene.coupling().has_listen() ? scene.coupling().listen() : "ipc://" + (socket_folder / name).string();
}

/// Where Open MPI starts the ranks, and how it gets there.
Words mpi_hosts(const v1::Hosts& hosts) {
  std::string list;
  for (const v1::FlowHost& host : hosts.flow())
    list += (list.empty() ? "" : ",") + host.name() + ":" + std::to_string(host.slots());
  Words words{"--host", list};
  const std::string agent = mpi_agent(hosts);
  if (!agent.empty()) add(words, {"--mca", "plm", "rsh", "--mca", "plm_rsh_agent", agent});
  if (hosts.has_network()) {
    add(words, {"--mca", "oob_tcp_if_include", hosts.network(), "--mca", "btl_tcp_if_include", hosts.network()});
    add(words, {"--mca", "btl", "self,vader,tcp"});
  }
  return words;
}

/// --bind-to none and yielding: the default would put waiting and working processes on the same core.
ProgramStart mpi_job(const Words& processes, const std::string& owner_of_time, const Words& where = {}) {
  Words command{"mpirun", "--oversubscribe", "--bind-to", "none", "--tag-output"};
  add(command, where);
  add(command, processes);
  return {
      "mpirun",
      command,
      {{"OMPI_ALLOW_RUN_AS_ROOT", "1"}, {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"}, {"OMPI_MCA_mpi_yield_when_idle", "1"}},
      {},
      owner_of_time};
}

/// The same program, as often as there are ranks.
ProgramStart on_ranks(int n_ranks, const ProgramStart& one, const Words& where = {}) {
  Words processes{"-n", std::to_string(n_ranks)};
  add(processes, one.command);
  return mpi_job(processes, one.name, where);
}

/// The flow server on all of its hosts, or a program on its only one.
ProgramStart on_hosts(const ProgramStart& start, const RunOptions& options, const v1::Hosts& hosts) {
  const bool is_flow = start.name == "flow-server", is_mpi_job = options.flow_ranks > 1 || hosts.flow_size() > 1;
  ProgramStart there = is_flow && is_mpi_job ? on_ranks(options.flow_ranks, start, mpi_hosts(hosts)) : start;
  there.host = is_flow                        ? hosts.flow(0).name()
               : start.name == "solid-server" ? hosts.solid().name()
                                              : hosts.coupler().name();
  return there;
}

/// What the programs listen on where each has a host.
std::string network_address(const std::string& name, const v1::Hosts& hosts) {
  const auto at = [](const auto& host) { return "tcp://" + numeric_address(host.name(), host.address()) + ":*"; };
  return name == "flow" ? at(hosts.flow(0)) : at(hosts.solid());
}

/// What any program can be expected to know: serve --listen ADDRESS SCENE. The rest is added where the scene asks for
/// it.
ProgramStart own_program(const std::string& name, const std::string& text, const std::string& address,
                         const v1::Scene& scene, const RunOptions& options, const Installation& installation) {
  Words command = split_command("--" + name, text);
  add(command, {"serve", "--listen", address});
  if (scene.coupling().has_heartbeat_deadline())
    add(command, {"--heartbeat", scene::number_text(scene.coupling().heartbeat_deadline())});
  if (!options.keys.empty())
    add(command, {"--key", (std::filesystem::absolute(options.keys) / (name + "-server.key")).string()});
  add(command, {options.scene.string()});
  return {name + " \"" + text + "\"", command, own_program_environment(installation), {}, {}, true};
}

LaunchPlan over_zeromq(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                       const std::filesystem::path& run_folder, const std::filesystem::path& socket_folder,
                       const std::optional<v1::Hosts>& hosts) {
  LaunchPlan plan;
  plan.transport = "zmq";
  for (const std::string name : {"flow", "solid"}) {
    const std::string program = name + "-server";
    const std::string address = hosts ? network_address(name, *hosts) : listen_address(scene, socket_folder, name);
    const std::string& own = name == "flow" ? options.own_flow : options.own_solid;
    if (!own.empty()) {
      plan.servers.push_back(own_program(name, own, address, scene, options, installation));
      plan.servers.back().address_option = "--" + name;
      if (hosts) plan.servers.back().host = name == "flow" ? hosts->flow(0).name() : hosts->solid().name();
      continue;
    }
    Words command{installation.program(program), "serve"};
    add(command, scene_arguments(options));
    add(command, {"--listen", address});
    add(command, {"--heartbeat", scene::number_text(scene.coupling().heartbeat_deadline())});
    add(command, key_arguments(options));
    if (name == "solid") add(command, thread_arguments(options));
    ProgramStart server{program, command, {}, {}, {}};
    if (hosts)
      server = on_hosts(server, options, *hosts);
    else if (name == "flow" && options.flow_ranks > 1)
      server = on_ranks(options.flow_ranks, server);
    server.address_option = "--" + name;
    plan.servers.push_back(server);
  }
  Words command{installation.program("coupler"), "run"};
  add(command, run_arguments(options, run_folder));
  add(command, key_arguments(options));
  plan.leader = {"coupler", command, {}, {}, {}};
  if (hosts) plan.leader = on_hosts(plan.leader, options, *hosts);
  return plan;
}

/// One job of three programs.
LaunchPlan over_mpi(const RunOptions& options, const Installation& installation,
                    const std::filesystem::path& run_folder) {
  Words processes{"-n", "1", installation.program("coupler"), "run"};
  add(processes, run_arguments(options, run_folder));
  add(processes, {"--transport", "mpi", ":", "-n", std::to_string(options.flow_ranks)});
  add(processes, {installation.program("flow-server"), "serve", "--transport", "mpi"});
  add(processes, scene_arguments(options));
  add(processes, {":", "-n", "1", installation.program("solid-server"), "serve", "--transport", "mpi"});
  add(processes, scene_arguments(options));
  add(processes, thread_arguments(options));
  return {{}, mpi_job(processes, "coupler"), "mpi"};
}

/// Programs of the user's own take part in coupled runs over ZeroMQ, and have their own options.
void check_own_programs(const v1::Scene& scene, const RunOptions& options) {
  if (options.own_flow.empty() && options.own_solid.empty()) return;
  const std::string option = options.own_solid.empty() ? "--flow" : "--solid";
  if (!scene.has_flow() || !scene.has_solid()) {
    throw report::SceneError(option,
                             std::string("the scene has no ") + (scene.has_flow() ? "solid" : "flow") +
                                 ", so nothing would be coupled with this program",
                             "take a scene with both");
  }
  if (choose_transport(scene, options) == "mpi") {
    throw report::SceneError(option, "a program of your own is reached over ZeroMQ, not inside an MPI job",
                             options.transport.empty() ? "add --transport zmq" : "leave --transport mpi out");
  }
  if (!options.own_flow.empty() && options.flow_ranks > 1) {
    throw report::SceneError("--flow-ranks", "is for flow-server, which --flow replaces",
                             "let the command start its own ranks, for example --flow \"mpirun -n 2 my_flow\"");
  }
  if (!options.own_solid.empty() && options.solid_threads > 0) {
    throw report::SceneError("--solid-threads", "is for solid-server, which --solid replaces",
                             "give the number of threads in the command");
  }
}

ProgramStart flow_alone(const RunOptions& options, const Installation& installation,
                        const std::filesystem::path& run_folder, const std::optional<v1::Hosts>& hosts) {
  ProgramStart start = alone("flow-server", {}, options, installation, run_folder);
  if (hosts) return on_hosts(start, options, *hosts);
  if (options.flow_ranks > 1) start = on_ranks(options.flow_ranks, start);
  return start;
}

ProgramStart solid_alone(const RunOptions& options, const Installation& installation,
                         const std::filesystem::path& run_folder, const std::optional<v1::Hosts>& hosts) {
  const ProgramStart start = alone("solid-server", thread_arguments(options), options, installation, run_folder);
  return hosts ? on_hosts(start, options, *hosts) : start;
}

void check_hosts(const RunOptions& options, const v1::Hosts& hosts, const std::string& transport) {
  if (transport == "mpi")
    throw report::SceneError("--hosts", "across hosts the programs talk over ZeroMQ", "add --transport zmq");
  if (options.flow_ranks > n_slots(hosts))
    throw report::SceneError("--flow-ranks",
                             std::to_string(options.flow_ranks) + " is more than the " +
                                 std::to_string(n_slots(hosts)) + " slots of the hosts of the flow",
                             "add hosts or slots to " + options.hosts.string());
  if (transport == "zmq" && options.keys.empty())
    throw report::SceneError("--hosts", "the programs talk over a network and have no keys",
                             "make them once with `couplet keys DIR`, and add --keys DIR");
}

}  // namespace

LaunchPlan plan_launch(const v1::Scene& scene, const RunOptions& given, const Installation& installation,
                       const std::filesystem::path& run_folder, const std::filesystem::path& socket_folder,
                       const std::optional<v1::Hosts>& hosts) {
  RunOptions options = given;
  if (hosts && options.solid_threads == 0 && hosts->solid().has_threads())
    options.solid_threads = hosts->solid().threads();
  if (scene.has_flow() && options.flow_ranks > 1 && scene.flow().has_glottis()) {
    throw report::SceneError("--flow-ranks", "one-dimensional flow runs on one rank", "leave --flow-ranks out");
  }
  if (!scene.has_flow() && !scene.has_solid()) {
    throw report::SceneError(options.scene.string(), "the scene has neither flow nor solid",
                             "name at least one of them");
  }
  check_own_programs(scene, given);
  if (!scene.has_flow()) {
    return {{}, solid_alone(options, installation, run_folder, hosts), {}};
  }
  if (!scene.has_solid()) return {{}, flow_alone(options, installation, run_folder, hosts), {}};
  const std::string transport = choose_transport(scene, options);
  if (hosts) check_hosts(options, *hosts, transport);
  if (transport == "mpi" && !options.keys.empty()) {
    throw report::SceneError("--keys", "MPI does not encrypt", "add --transport zmq, or leave --keys out");
  }
  return transport == "mpi" ? over_mpi(options, installation, run_folder)
                            : over_zeromq(scene, options, installation, run_folder, socket_folder, hosts);
}

}  // namespace couplet::launcher
