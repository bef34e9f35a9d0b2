#include "deploy/launcher/launch_plan.hpp"

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

/// --bind-to none and yielding: the default would put waiting and working processes on the same core.
ProgramStart mpi_job(const Words& processes, const std::string& owner_of_time) {
  Words command{"mpirun", "--oversubscribe", "--bind-to", "none", "--tag-output"};
  add(command, processes);
  return {
      "mpirun",
      command,
      {{"OMPI_ALLOW_RUN_AS_ROOT", "1"}, {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"}, {"OMPI_MCA_mpi_yield_when_idle", "1"}},
      {},
      owner_of_time};
}

/// The same program, as often as there are ranks.
ProgramStart on_ranks(int n_ranks, const ProgramStart& one) {
  Words processes{"-n", std::to_string(n_ranks)};
  add(processes, one.command);
  return mpi_job(processes, one.name);
}

/// What any program can be expected to know: serve --listen ADDRESS SCENE. The rest is added where the scene asks for
/// it.
ProgramStart own_program(const std::string& name, const std::string& text, const std::string& address,
                         const v1::Scene& scene, const RunOptions& options, const Installation& installation) {
  Words command = split_command("--" + name, text);
  add(command, {"serve", "--listen", address});
  if (scene.coupling().has_heartbeat_deadline())
    add(command, {"--heartbeat", scene::number_text(scene.coupling().heartbeat_deadline())});
  if (scene.coupling().has_listen()) add(command, {"--allow-remote"});
  add(command, {options.scene.string()});
  return {name + " \"" + text + "\"", command, own_program_environment(installation), {}, {}, true};
}

LaunchPlan over_zeromq(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                       const std::filesystem::path& run_folder, const std::filesystem::path& socket_folder) {
  LaunchPlan plan;
  plan.transport = "zmq";
  for (const std::string name : {"flow", "solid"}) {
    const std::string program = name + "-server";
    const std::string address = listen_address(scene, socket_folder, name);
    const std::string& own = name == "flow" ? options.own_flow : options.own_solid;
    if (!own.empty()) {
      plan.servers.push_back(own_program(name, own, address, scene, options, installation));
      plan.servers.back().address_option = "--" + name;
      continue;
    }
    Words command{installation.program(program), "serve"};
    add(command, scene_arguments(options));
    add(command, {"--listen", address});
    add(command, {"--heartbeat", scene::number_text(scene.coupling().heartbeat_deadline())});
    if (scene.coupling().has_listen())
      add(command, {"--allow-remote"});  // the scene names the address: that is the permission
    if (name == "solid") add(command, thread_arguments(options));
    ProgramStart server{program, command, {}, {}, {}};
    if (name == "flow" && options.flow_ranks > 1) server = on_ranks(options.flow_ranks, server);
    server.address_option = "--" + name;
    plan.servers.push_back(server);
  }
  Words command{installation.program("coupler"), "run"};
  add(command, run_arguments(options, run_folder));
  plan.leader = {"coupler", command, {}, {}, {}};
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
                        const std::filesystem::path& run_folder) {
  ProgramStart start = alone("flow-server", {}, options, installation, run_folder);
  if (options.flow_ranks > 1) start = on_ranks(options.flow_ranks, start);
  return start;
}

}  // namespace

LaunchPlan plan_launch(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                       const std::filesystem::path& run_folder, const std::filesystem::path& socket_folder) {
  if (scene.has_flow() && options.flow_ranks > 1 && scene.flow().has_glottis()) {
    throw report::SceneError("--flow-ranks", "one-dimensional flow runs on one rank", "leave --flow-ranks out");
  }
  if (!scene.has_flow() && !scene.has_solid()) {
    throw report::SceneError(options.scene.string(), "the scene has neither flow nor solid",
                             "name at least one of them");
  }
  check_own_programs(scene, options);
  if (!scene.has_flow()) {
    return {{}, alone("solid-server", thread_arguments(options), options, installation, run_folder), {}};
  }
  if (!scene.has_solid()) return {{}, flow_alone(options, installation, run_folder), {}};
  return choose_transport(scene, options) == "mpi"
             ? over_mpi(options, installation, run_folder)
             : over_zeromq(scene, options, installation, run_folder, socket_folder);
}

}  // namespace couplet::launcher
