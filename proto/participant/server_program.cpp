#include "proto/participant/server_program.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/participant/run_alone.hpp"
#include "proto/participant/serve_participant.hpp"
#include "proto/participant/stop_signal.hpp"
#include "proto/report/failure.hpp"
#include "proto/report/version.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/wire/mpi_job.hpp"
#include "proto/wire/zeromq_channel.hpp"

namespace couplet::participant {

namespace {

struct CommandLine {
  std::string listen = "tcp://127.0.0.1:*";
  std::string transport = "zmq";
  std::string scene, keys;
  std::vector<std::string> settings;
  ServerOptions server;
  wire::ZeromqOptions zeromq;
  AloneOptions alone;
  bool json = false;
};

ServeOptions make_serve_options(const ServerProgram& program, const CommandLine& line) {
  ServeOptions options;
  options.program = program.name;
  options.threads =
      line.server.threads > 0 ? line.server.threads : static_cast<int>(std::thread::hardware_concurrency());
  if (!line.scene.empty()) {
    // A scene that is given here is refused here; afterwards only its folder matters, the coupler sends the scene.
    scene::load_scene(line.scene, line.settings);
    options.scene_folder = std::filesystem::absolute(line.scene).parent_path().string();
  }
  options.should_end = stop_was_asked;
  return options;
}

int rank_in(MPI_Comm ranks) {
  int rank = 0;
  MPI_Comm_rank(ranks, &rank);
  return rank;
}

int size_of(MPI_Comm ranks) {
  int size = 1;
  MPI_Comm_size(ranks, &size);
  return size;
}

int serve_in_mpi(const ServerProgram& program, const CommandLine& line) {
  return wire::run_in_mpi(program.name, [&](wire::MpiJob& job) {
    ServeOptions options = make_serve_options(program, line);
    catch_stop_signals();
    const auto role = program.name == "flow-server" ? wire::MpiRole::flow : wire::MpiRole::solid;
    const wire::MpiConnections connections = job.connect(role, {line.zeromq.heartbeat_deadline});
    if (!program.follow && size_of(connections.group) > 1)
      throw report::SceneError("MPI job", "has more than one " + program.name, "start it with -n 1");
    ServerOptions server = line.server;
    server.ranks = connections.group;
    if (rank_in(connections.group) > 0) {
      program.follow(server);
      return 0;
    }
    const auto participant = program.make_participant(server);
    options.ranks = size_of(connections.group);
    serve_participant(*connections.coupler, *participant, options);
    return 0;
  });
}

/// Does the work of rank 0 there, and follows it on the other ranks of a program that can.
int on_all_ranks(const ServerProgram& program, const CommandLine& line,
                 const std::function<void(const ServerOptions&)>& work) {
  if (!program.follow) {
    work(line.server);
    return 0;
  }
  return wire::run_in_mpi(program.name, [&](wire::MpiJob& job) {
    ServerOptions server = line.server;
    server.ranks = job.join_all();
    catch_stop_signals();
    rank_in(server.ranks) == 0 ? work(server) : program.follow(server);
    return 0;
  });
}

int serve(const ServerProgram& program, const CommandLine& line) {
  if (line.transport == "mpi") return serve_in_mpi(program, line);
  return on_all_ranks(program, line, [&](const ServerOptions& server) {
    const auto participant = program.make_participant(server);  // first: whatever fails now, the other ranks hear of it
    ServeOptions options = make_serve_options(program, line);
    if (server.ranks != MPI_COMM_NULL) options.ranks = size_of(server.ranks);
    catch_stop_signals();
    wire::ZeromqOptions zeromq = line.zeromq;
    if (!line.keys.empty()) zeromq.keys = wire::read_curve_keys(line.keys, program.name, "coupler");
    const auto channel = wire::listen_zeromq(line.listen, zeromq);
    std::printf("listening %s\n", channel->describe().c_str());
    std::fflush(stdout);
    serve_participant(*channel, *participant, options);
  });
}

int run(const ServerProgram& program, const CommandLine& line) {
  return on_all_ranks(program, line, [&](const ServerOptions& server) {
    const auto participant = program.make_participant(server);  // first: whatever fails now, the other ranks hear of it
    const scene::SceneFile file = scene::load_scene(line.scene, line.settings);
    AloneOptions options = line.alone;
    options.program = program.name;
    options.scene_path = line.scene;
    run_alone(*participant, file.scene, options);
  });
}

OpenRequest read_request(const CommandLine& line) {
  OpenRequest request;
  request.scene = scene::load_scene(line.scene, line.settings).scene;
  request.scene_folder = std::filesystem::absolute(line.scene).parent_path().string();
  return request;
}

int do_verb(const SceneVerb& verb, const CommandLine& line) {
  OpenRequest request = read_request(line);
  request.run_folder = line.alone.run_folder;
  verb.work(request, line.server);
  return 0;
}

int check(const ServerProgram& program, const CommandLine& line) {
  const std::vector<NamedNumber> numbers = program.estimate(read_request(line));
  if (line.json) {
    nlohmann::ordered_json object;
    for (const auto& number : numbers) {
      if (number.text.empty())
        object[number.name] = {{"value", number.value}, {"unit", number.unit}};
      else
        object[number.name] = {{"text", number.text}};
    }
    std::printf("%s\n", object.dump(2).c_str());
    return 0;
  }
  std::size_t width = 0;
  for (const auto& number : numbers) width = std::max(width, number.name.size());
  for (const auto& number : numbers) {
    if (!number.text.empty()) {
      std::printf("%-*s  %s\n", static_cast<int>(width), number.name.c_str(), number.text.c_str());
      continue;
    }
    const std::string unit = number.unit == "1" ? "" : " " + number.unit;
    std::printf("%-*s  %.6g%s\n", static_cast<int>(width), number.name.c_str(), number.value, unit.c_str());
  }
  return 0;
}

int print_version(const ServerProgram& program) {
  std::printf("%s %s, commit %s, %s\n", program.name.c_str(), report::version().c_str(), report::commit().c_str(),
              report::compiler().c_str());
  return 0;
}

void add_serve(CLI::App& app, CommandLine& line) {
  auto* serve = app.add_subcommand("serve", "serve one session of a coupler, then end");
  serve->add_option("scene", line.scene, "scene that is checked first; relative paths start at its folder");
  serve->add_option("--listen", line.listen, "bind there: tcp://127.0.0.1:* (any free port), ipc://PATH, ipc://@NAME")
      ->capture_default_str();
  serve->add_option("--transport", line.transport, "zmq, or mpi inside one MPI job")
      ->check(CLI::IsMember({"zmq", "mpi"}))
      ->capture_default_str();
  serve->add_option("--threads", line.server.threads, "threads to compute with; 0: all cores")
      ->check(CLI::NonNegativeNumber);
  serve
      ->add_option("--heartbeat", line.zeromq.heartbeat_deadline,
                   "seconds without sign of life after which the coupler is lost")
      ->check(CLI::Range(0.5, 1e6))
      ->capture_default_str();
  serve->add_option("--wait", line.zeromq.connect_deadline, "seconds to wait for the coupler to come")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  serve->add_option("--keys", line.keys,
                    "folder of keys made by `couplet keys`: encrypt, and obey the coupler with the right key only; "
                    "must be given where other machines can reach the address");
  serve->add_option("--set", line.settings, "PATH=VALUE for the scene that is checked")->take_all();
}

void add_run(CLI::App& app, CommandLine& line) {
  auto* run = app.add_subcommand("run", "run a scene alone, against prescribed loads");
  run->add_option("scene", line.scene, "scene file")->required();
  run->add_option("--out", line.alone.run_folder, "folder for the results")->required();
  run->add_option("--set", line.settings, "PATH=VALUE changes a field of the scene")->take_all();
  run->add_option("--steps", line.alone.steps, "stop after this many steps; 0: at the end of the scene")
      ->check(CLI::NonNegativeNumber);
  run->add_option("--resume", line.alone.resume_from, "run folder or checkpoint folder to continue from");
  run->add_option("--threads", line.server.threads, "threads to compute with; 0: all cores")
      ->check(CLI::NonNegativeNumber);
  run->add_flag("--quiet", line.alone.quiet, "no progress line");
}

void add_check(CLI::App& app, CommandLine& line) {
  auto* check = app.add_subcommand("check", "say what a run of a scene would need, without running it");
  check->add_option("scene", line.scene, "scene file")->required();
  check->add_option("--set", line.settings, "PATH=VALUE changes a field of the scene")->take_all();
  check->add_flag("--json", line.json, "as one JSON object");
}

void add_verb(CLI::App& app, const SceneVerb& verb, CommandLine& line) {
  auto* added = app.add_subcommand(verb.name, verb.purpose);
  added->add_option("scene", line.scene, "scene file")->required();
  added->add_option("--out", line.alone.run_folder, "folder for the results; without it they are only printed");
  added->add_option("--set", line.settings, "PATH=VALUE changes a field of the scene")->take_all();
  added->add_option("--threads", line.server.threads, "threads to compute with; 0: all cores")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace

int run_server_program(const ServerProgram& program, int argc, char** argv) {
  CommandLine line;
  CLI::App app(program.purpose, program.name);
  app.require_subcommand(1);
  add_serve(app, line);
  add_run(app, line);
  add_check(app, line);
  for (const SceneVerb& verb : program.verbs) add_verb(app, verb, line);
  app.add_subcommand("version", "print version, commit and compiler");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& stop) {
    if (stop.get_exit_code() == 0) return app.exit(stop);  // --help
    throw report::SceneError("command line", stop.what(), program.name + " --help says what is possible");
  }
  const std::string verb = app.get_subcommands().front()->get_name();
  if (verb == "serve") return serve(program, line);
  if (verb == "run") return run(program, line);
  if (verb == "check") return check(program, line);
  for (const SceneVerb& other : program.verbs)
    if (verb == other.name) return do_verb(other, line);
  return print_version(program);
}

}  // namespace couplet::participant
