#include "coupler/program/coupler_program.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "coupler/scheme/coupled_run.hpp"
#include "proto/participant/remote_participant.hpp"
#include "proto/participant/stop_signal.hpp"
#include "proto/report/failure.hpp"
#include "proto/report/version.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/wire/mpi_job.hpp"
#include "proto/wire/zeromq_channel.hpp"

namespace couplet::coupling {

namespace {

struct CommandLine {
  std::string scene;
  std::vector<std::string> settings;
  std::string flow, solid;  // addresses
  std::string keys;         // folder; empty: nothing is encrypted
  std::string transport;    // empty: as the scene says
  CoupledRunOptions run;
};

v1::Transport choose_transport(const CommandLine& line, const v1::Scene& scene) {
  if (line.transport == "mpi") return v1::MPI;
  return line.transport == "zmq" ? v1::ZEROMQ : scene.coupling().transport();
}

std::unique_ptr<wire::Channel> connect(const std::string& name, const std::string& address, const std::string& keys,
                                       const v1::Coupling& coupling) {
  if (address.empty()) {
    throw report::SceneError("command line", "the address of the " + name + " server is missing",
                             "give --" + name + " ADDRESS, as the server printed it after 'listening'");
  }
  wire::ZeromqOptions options;
  options.heartbeat_deadline = coupling.heartbeat_deadline();
  if (!keys.empty()) options.keys = wire::read_curve_keys(keys, "coupler", name + "-server");
  return wire::connect_zeromq(address, options);
}

std::unique_ptr<participant::Participant> make_remote(const std::string& name, std::unique_ptr<wire::Channel> channel,
                                                      const CommandLine& line, const v1::Coupling& coupling) {
  participant::RemoteOptions options;
  options.name = name;
  options.run = line.run.run_folder.filename().string();
  options.reply_deadline = coupling.peer_deadline();
  return std::make_unique<participant::RemoteParticipant>(std::move(channel), options);
}

struct Servers {
  std::unique_ptr<participant::Participant> flow, solid;
};

Servers connect_by_zeromq(const CommandLine& line, const v1::Coupling& coupling) {
  return {make_remote("flow", connect("flow", line.flow, line.keys, coupling), line, coupling),
          make_remote("solid", connect("solid", line.solid, line.keys, coupling), line, coupling)};
}

Servers connect_by_mpi(wire::MpiJob& job, const CommandLine& line, const v1::Coupling& coupling) {
  wire::MpiOptions options;
  options.heartbeat_deadline = coupling.heartbeat_deadline();
  wire::MpiConnections connections = job.connect(wire::MpiRole::coupler, options);
  for (const bool is_there : {connections.flow != nullptr, connections.solid != nullptr}) {
    if (is_there) continue;
    throw report::SceneError("command line", "the MPI job has no server for flow or none for solid",
                             "start coupler, flow-server and solid-server in one job");
  }
  return {make_remote("flow", std::move(connections.flow), line, coupling),
          make_remote("solid", std::move(connections.solid), line, coupling)};
}

void refuse_uncoupled(const v1::Scene& scene) {
  if (scene.has_flow() && scene.has_solid()) return;
  throw report::SceneError(scene.has_flow() ? "solid" : "flow", "the scene has nothing to couple",
                           scene.has_flow() ? "run it with flow-server run" : "run it with solid-server run");
}

int couple(const Servers& servers, const scene::SceneFile& file, const CommandLine& line) {
  run_coupled(*servers.flow, *servers.solid, file.scene, line.run);
  return 0;
}

int run(CommandLine line) {
  const scene::SceneFile file = scene::load_scene(line.scene, line.settings);
  refuse_uncoupled(file.scene);
  line.run.scene_path = line.scene;
  line.run.scene_folder = std::filesystem::absolute(line.scene).parent_path().string();
  participant::catch_stop_signals();
  line.run.should_stop = participant::stop_was_asked;
  const v1::Coupling& coupling = file.scene.coupling();
  switch (choose_transport(line, file.scene)) {
    case v1::ZEROMQ:
      return couple(connect_by_zeromq(line, coupling), file, line);
    case v1::MPI:
      return wire::run_in_mpi(
          "coupler", [&](wire::MpiJob& job) { return couple(connect_by_mpi(job, line, coupling), file, line); });
    case v1::MEMORY:
      break;
  }
  throw report::SceneError("coupling.transport", "MEMORY needs flow and solid in the coupler's own process",
                           "use ZEROMQ or MPI with three programs");
}

void add_run(CLI::App& app, CommandLine& line) {
  auto* run = app.add_subcommand("run", "couple a flow server and a solid server as a scene says");
  run->add_option("scene", line.scene, "scene file")->required();
  run->add_option("--flow", line.flow, "address of the flow server, as it printed it after 'listening'");
  run->add_option("--solid", line.solid, "address of the solid server");
  run->add_option("--out", line.run.run_folder, "folder for everything that the run leaves")->required();
  run->add_option("--set", line.settings, "PATH=VALUE changes a field of the scene")->take_all();
  run->add_option("--steps", line.run.steps, "accept so many steps and end; 0: go on to the end of the scene")
      ->check(CLI::NonNegativeNumber);
  run->add_option("--resume", line.run.resume_from, "run folder or checkpoint folder to continue from");
  run->add_option("--keys", line.keys,
                  "folder of keys made by `couplet keys`: the servers must have been given theirs");
  run->add_flag("--quiet", line.run.quiet, "no progress line");
  run->add_option("--transport", line.transport, "zmq, or mpi inside one MPI job; without it as the scene says")
      ->check(CLI::IsMember({"zmq", "mpi"}));
}

}  // namespace

int run_coupler_program(int argc, char** argv) {
  CommandLine line;
  CLI::App app("couples a flow server and a solid server", "coupler");
  app.require_subcommand(1);
  add_run(app, line);
  app.add_subcommand("version", "print version, commit and compiler");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& stop) {
    if (stop.get_exit_code() == 0) return app.exit(stop);  // --help
    throw report::SceneError("command line", stop.what(), "coupler --help says what is possible");
  }
  if (app.got_subcommand("run")) return run(line);
  std::printf("coupler %s, commit %s, %s\n", report::version().c_str(), report::commit().c_str(),
              report::compiler().c_str());
  return 0;
}

}  // namespace couplet::coupling
