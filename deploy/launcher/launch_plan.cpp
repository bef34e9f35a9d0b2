#include "deploy/launcher/launch_plan.hpp"

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

LaunchPlan over_zeromq(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                       const std::filesystem::path& run_folder, const std::filesystem::path& socket_folder) {
  LaunchPlan plan;
  plan.transport = "zmq";
  for (const std::string name : {"flow", "solid"}) {
    const std::string program = name + "-server";
    Words command{installation.program(program), "serve"};
    add(command, scene_arguments(options));
    add(command, {"--listen", listen_address(scene, socket_folder, name)});
    add(command, {"--heartbeat", scene::number_text(scene.coupling().heartbeat_deadline())});
    add(command, key_arguments(options));
    if (name == "solid") add(command, thread_arguments(options));
    ProgramStart server{program, command, {}, {}, {}};
    if (name == "flow" && options.flow_ranks > 1) server = on_ranks(options.flow_ranks, server);
    server.address_option = "--" + name;
    plan.servers.push_back(server);
  }
  Words command{installation.program("coupler"), "run"};
  add(command, run_arguments(options, run_folder));
  add(command, key_arguments(options));
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
  if (!scene.has_flow()) {
    return {{}, alone("solid-server", thread_arguments(options), options, installation, run_folder), {}};
  }
  if (!scene.has_solid()) return {{}, flow_alone(options, installation, run_folder), {}};
  const std::string transport = choose_transport(scene, options);
  if (transport == "mpi" && !options.keys.empty()) {
    throw report::SceneError("--keys", "MPI does not encrypt", "add --transport zmq, or leave --keys out");
  }
  return transport == "mpi" ? over_mpi(options, installation, run_folder)
                            : over_zeromq(scene, options, installation, run_folder, socket_folder);
}

}  // namespace couplet::launcher
