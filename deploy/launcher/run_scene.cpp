#include "deploy/launcher/run_scene.hpp"

#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <optional>

#include "deploy/launcher/checked_scene.hpp"
#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/flow_ranks.hpp"
#include "deploy/launcher/hosts.hpp"
#include "deploy/launcher/launch_plan.hpp"
#include "deploy/launcher/restarts.hpp"
#include "deploy/launcher/run_summary.hpp"
#include "deploy/launcher/socket_folder.hpp"
#include "deploy/launcher/supervisor.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::launcher {
namespace {

std::filesystem::path default_folder(const std::filesystem::path& scene) {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::tm local{};
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", localtime_r(&now, &local));
  const std::string name = std::filesystem::absolute(scene).parent_path().filename();
  const std::filesystem::path wanted = std::filesystem::path("runs") / (name + "-" + text);
  std::filesystem::path free = wanted;
  for (int n = 2; std::filesystem::exists(free); ++n) free = wanted.string() + "-" + std::to_string(n);
  return free;
}

/// A run never overwrites another one unasked. A run that is resumed goes on in its own folder unless told otherwise.
store::RunFolder choose_folder(const RunOptions& options) {
  const store::RunFolder resumed{options.resume};
  const bool resumes_folder = !options.resume.empty() && std::filesystem::exists(resumed.history());
  const store::RunFolder folder{!options.out.empty() ? options.out
                                : resumes_folder     ? options.resume
                                                     : default_folder(options.scene)};
  std::error_code ignored;
  const bool is_resumed = resumes_folder && std::filesystem::equivalent(folder.path, options.resume, ignored);
  if (std::filesystem::exists(folder.summary(), ignored) && !is_resumed && !options.force) {
    throw report::SceneError("--out " + folder.path.string(), "this folder already holds a run",
                             "choose another folder, or add --force to replace it");
  }
  return folder;
}

/// Makes the folder. What an earlier run left is removed where it is replaced; a resumed run needs it.
void prepare_folder(const store::RunFolder& folder, const RunOptions& options) {
  store::make_run_folder(folder.path);
  std::error_code ignored;
  std::filesystem::remove(folder.summary(), ignored);
  if (!options.force || !options.resume.empty()) return;
  for (const auto& left : {folder.history(), folder.iterations(), folder.report(), folder.log()}) {
    std::filesystem::remove(left, ignored);
  }
  std::filesystem::remove_all(folder.checkpoints(), ignored);
  std::filesystem::remove_all(folder.results(), ignored);
}

using Place = std::function<ProgramStart(const ProgramStart&)>;

/// `place` says how a program is started where it is to run.
RunEnding start_and_watch(const LaunchPlan& plan, const v1::Scene& scene, const Place& place, bool is_replaced,
                          RunConsole& console) {
  Patience patience;
  patience.is_replaced = is_replaced;
  patience.frozen = std::chrono::duration<double>(scene.coupling().heartbeat_deadline());
  Supervisor supervisor(console, patience);
  for (const ProgramStart& server : plan.servers) supervisor.start_server(place(server));
  ProgramStart leader = plan.leader;
  for (const ProgramStart& server : plan.servers) {
    const auto address = supervisor.wait_for_address(server.name);
    if (!address) return supervisor.end_all();
    leader.command.insert(leader.command.end(), {server.address_option, *address});
  }
  supervisor.start_leader(place(leader));
  return supervisor.run_to_end();
}

/// Those that can be reached; spare ones where others cannot.
std::optional<v1::Hosts> reachable(const std::optional<v1::Hosts>& hosts, RunConsole& console) {
  if (!hosts) return {};
  return replace_lost(
      *hosts, [&](const std::string& host) { return answers(host, *hosts); },
      [&](const std::string& sentence) { console.note(sentence); });
}

/// What replaces flow or solid, by these names.
std::map<std::string, std::string> own_programs(const RunOptions& options) {
  std::map<std::string, std::string> commands;
  if (!options.own_flow.empty()) commands["flow"] = options.own_flow;
  if (!options.own_solid.empty()) commands["solid"] = options.own_solid;
  return commands;
}

/// A failure of a run in which they take part names them.
void name_own_programs(Verdict& verdict, const std::map<std::string, std::string>& own) {
  if (verdict.exit_code == 0) return;
  for (const auto& [name, command] : own) {
    if (verdict.sentence.find(command) == std::string::npos)
      verdict.sentence += " (" + name + " is the program \"" + command + "\")";
  }
}

/// Whether it has been written.
bool write_report(const store::RunFolder& folder, const Installation& installation, RunConsole& console) {
  const ProgramResult result =
      run_and_catch({installation.python, installation.script("deploy/report/report.py"), folder.path.string()});
  if (result.exit_code == 0) return true;
  console.log("report", result.output + result.errors);
  console.show("the report could not be written; log.txt says why");
  return false;
}

}  // namespace

int run_scene(const RunOptions& options) {
  const Installation installation = find_installation();
  const scene::SceneFile file = read_checked_scene(options.scene, options.settings);
  const SocketFolder sockets;
  const store::RunFolder folder = choose_folder(options);
  std::optional<v1::Hosts> hosts;
  if (!options.hosts.empty()) hosts = read_hosts(options.hosts);
  RunOptions chosen = options;
  if (options.own_flow.empty()) {
    chosen.flow_ranks = hosts ? choose_flow_ranks(file.scene, options, installation, n_slots(*hosts))
                              : choose_flow_ranks(file.scene, options, installation);
  }
  LaunchPlan plan = plan_launch(file.scene, chosen, installation, folder.path, sockets.path(), hosts);
  prepare_folder(folder, options);
  RunConsole console(folder.log(), options.quiet);
  console.show(file.scene.title() + "\n  results in " + folder.path.string());
  hosts = reachable(hosts, console);
  plan = plan_launch(file.scene, chosen, installation, folder.path, sockets.path(), hosts);

  const std::map<std::string, std::string> own = own_programs(options);
  for (const auto& [name, command] : own) console.note(name + " is the program \"" + command + "\"");

  const Place place = [&](const ProgramStart& start) {
    return hosts ? through_remote_shell(start, *hosts, installation.program("couplet")) : start;
  };
  Restarts restarts(chosen, folder);
  RunEnding ending = start_and_watch(plan, file.scene, place, options.restarts > 0, console);
  while (const auto next = restarts.after(judge(ending), ending.stop_requested)) {
    console.note(judge(ending).sentence);
    console.note("started again " + restarts.from_where());
    hosts = reachable(hosts, console);
    plan = plan_launch(file.scene, *next, installation, folder.path, sockets.path(), hosts);
    ending = start_and_watch(plan, file.scene, place, true, console);
  }
  Verdict verdict = restarts.settle(judge(ending));
  name_own_programs(verdict, own);
  settle_summary(folder, options.scene.string(), verdict, ending.stop_requested, restarts.n_restarts(), own);
  const bool has_report = options.report && write_report(folder, installation, console);

  if (!options.quiet) std::printf("%s", summary_table(folder).c_str());
  if (!options.quiet && has_report) {
    std::printf("report: %s\n", std::filesystem::absolute(folder.report()).lexically_normal().c_str());
  }
  std::fflush(stdout);
  if (verdict.exit_code != 0) {
    console.log("couplet", verdict.sentence);
    std::fprintf(stderr, "%s\n", verdict.sentence.c_str());
  }
  return verdict.exit_code;
}

}  // namespace couplet::launcher
