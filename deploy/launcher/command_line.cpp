#include "deploy/launcher/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>

#include "deploy/launcher/attendant.hpp"
#include "deploy/launcher/batch_job.hpp"
#include "deploy/launcher/cases.hpp"
#include "deploy/launcher/check_participant.hpp"
#include "deploy/launcher/check_scene.hpp"
#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/make_keys.hpp"
#include "deploy/launcher/run_scene.hpp"
#include "deploy/launcher/version_text.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/describe_schema.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::launcher {
namespace {

using Words = std::vector<std::string>;

/// The verbs, and what the chosen one does once the command line has been read.
struct CommandLine {
  CLI::App app{"Couplet: fluid-structure interaction of soft tissue. SI units."};
  RunOptions run;
  BatchOptions batch;
  ParticipantCheckOptions participant;
  Words reported;
  std::string outline;
  std::string message, keys;
  bool is_slurm = false;
  std::function<int()> action;
};

void add_scene_options(CLI::App& verb, RunOptions& run) {
  verb.add_option("SCENE", run.scene, "scene file (scene.txtpb)")->required();
  verb.add_option("--set", run.settings, "PATH=VALUE: change a field of the scene; may be given again")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
}

void add_run_options(CLI::App& verb, RunOptions& run) {
  add_scene_options(verb, run);
  verb.add_option("--out", run.out, "folder of the run; default runs/SCENE-DATE-TIME")->type_name("DIR");
  verb.add_option("--flow-ranks", run.flow_ranks, "MPI ranks of the flow server; default: as suits the grid")
      ->check(CLI::Range(1, 1 << 20));
  verb.add_option("--solid-threads", run.solid_threads, "threads of the solid server")->check(CLI::Range(1, 4096));
  verb.add_option("--transport", run.transport, "how the programs talk; default: as the scene says")
      ->check(CLI::IsMember({"mpi", "zmq"}));
  verb.add_option("--hosts", run.hosts, "file that says which program runs on which host (describe Hosts)")
      ->type_name("FILE");
  verb.add_option("--keys", run.keys, "folder made by `couplet keys`: the programs prove who they are and encrypt")
      ->type_name("DIR");
  verb.add_option("--flow", run.own_flow,
                  "a program of your own in the place of flow-server, with its options in quotes")
      ->type_name("COMMAND");
  verb.add_option("--solid", run.own_solid, "a program of your own in the place of solid-server")->type_name("COMMAND");
  verb.add_option("--resume", run.resume, "run folder or checkpoint to continue from")->type_name("DIR");
  verb.add_option("--steps", run.steps, "stop after so many steps")->check(CLI::PositiveNumber);
  verb.add_option(
          "--restarts", run.restarts,
          "how often in a row, without a further checkpoint, a run goes on by itself after it has lost a program")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  verb.add_flag("--quiet", run.quiet, "say nothing but what went wrong");
  verb.add_flag("--force", run.force, "replace a run that is in the folder already");
  verb.add_flag("!--no-report", run.report, "do not write report.html at the end");
}

void add_verbs_that_run(CommandLine& line) {
  CLI::App* run = line.app.add_subcommand("run", "run what the scene needs and nothing else");
  add_run_options(*run, line.run);
  run->callback([&line] { line.action = [&line] { return run_scene(line.run); }; });

  CLI::App* check = line.app.add_subcommand("check", "every complaint about a scene, or what a run of it takes");
  add_scene_options(*check, line.run);
  check->callback([&line] {
    line.action = [&line] {
      check_scene(line.run.scene, line.run.settings);
      return 0;
    };
  });

  CLI::App* participant = line.app.add_subcommand(
      "check-participant", "whether a program of your own keeps to the protocol, a line for each rule");
  participant->add_option("COMMAND", line.participant.command, "the program with its options, in quotes")->required();
  participant->add_option("--scene", line.participant.scene, "scene that it opens; default: a coarse vocal fold")
      ->type_name("SCENE");
  participant->add_option("--set", line.participant.settings, "PATH=VALUE: change a field of that scene")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
  participant->add_option("--rule", line.participant.rules, "only rules that hold this text; may be given again")
      ->allow_extra_args(false)
      ->type_name("TEXT");
  participant->callback([&line] {
    line.action = [&line] {
      check_participant(line.participant);
      return 0;
    };
  });

  CLI::App* submit = line.app.add_subcommand("submit", "write a batch job for a scene and submit it");
  add_run_options(*submit, line.batch.run);
  submit->get_option("--out")->required();
  submit->add_flag("--slurm", line.is_slurm, "for the scheduler Slurm (there is no other yet)")->required();
  submit->add_flag("--dry-run", line.batch.dry_run, "write the job but do not submit it");
  submit->add_option("--partition", line.batch.partition, "partition of the site");
  submit->add_option("--time", line.batch.time_limit, "time limit, for example 02:00:00");
  submit->add_option("--nodes", line.batch.nodes, "nodes; of several the last one is for solid and coupler")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  submit->add_option("--network", line.batch.network, "network that the ranks of the flow use, as 10.0.0.0/24");
  submit->add_option("--cpus", line.batch.cpus, "cores of each node; default: flow ranks + solid threads")
      ->check(CLI::PositiveNumber);
  submit->callback([&line] {
    line.action = [&line] {
      submit_batch_job(line.batch);
      return 0;
    };
  });
}

void add_verbs_that_tell(CommandLine& line) {
  CLI::App* describe = line.app.add_subcommand("describe", "the reference of the scene language");
  describe->add_option("MESSAGE", line.message, "one message, for example Body; default: all");
  describe->callback([&line] {
    line.action = [&line] {
      std::fputs(scene::describe_schema(line.message).c_str(), stdout);
      return 0;
    };
  });

  CLI::App* report = line.app.add_subcommand("report", "write report.html of a run, or a comparison of several");
  report->add_option("DIR", line.reported, "run folders")->required();
  report
      ->add_option("--outline", line.outline,
                   "also write the outline of the fold over a cycle, mean of all that are stored, to this SVG file")
      ->option_text("FILE");
  report->callback([&line] {
    line.action = [&line] {
      const Installation installation = find_installation();
      Words command{installation.python, installation.script("deploy/report/report.py"), "--print"};
      command.insert(command.end(), line.reported.begin(), line.reported.end());
      if (!line.outline.empty()) command.insert(command.end(), {"--outline", line.outline});
      become_program(command);
      return 0;
    };
  });

  CLI::App* keys = line.app.add_subcommand("keys", "make the key pairs for encrypted runs across hosts");
  keys->add_option("DIR", line.keys, "folder for the keys")->required();
  keys->callback([&line] {
    line.action = [&line] {
      make_keys(line.keys);
      return 0;
    };
  });

  CLI::App* attend = line.app.add_subcommand("attend", "stand beside a program on another host for the launcher");
  attend->group("")->prefix_command();  // not for users
  attend->callback(
      [&line, attend] { line.action = [words = attend->remaining()] { return launcher::attend(words); }; });

  line.app.add_subcommand("version", "version, commit, compiler, library versions")->callback([&line] {
    line.action = [] {
      std::fputs(version_text().c_str(), stdout);
      return 0;
    };
  });
}

/// Verbs whose arguments belong to another program.
int hand_over(const std::string& verb, const Words& arguments) {
  const Installation installation = find_installation();
  if (verb == "study") {
    Words command{installation.python, installation.script("deploy/study/study.py"), "--couplet",
                  installation.program("couplet")};
    command.insert(command.end(), arguments.begin(), arguments.end());
    become_program(command);
  }
  const bool has_name = !arguments.empty() && !arguments.front().starts_with("-");
  if (!has_name && !arguments.empty() && arguments.front() != "--help" && arguments.front() != "-h") {
    throw report::SceneError(verb + " " + arguments.front(), "a name must come first",
                             "`couplet " + verb + "` lists the names");
  }
  if (!has_name) {
    verb == "bench" ? list_benchmarks(installation) : list_validations(installation);
    return 0;
  }
  const Words rest(arguments.begin() + 1, arguments.end());
  if (verb == "bench") run_benchmark(installation, arguments.front(), rest);
  run_validation(installation, arguments.front(), rest);
}

void add_verbs_that_hand_over(CommandLine& line) {
  line.app.add_subcommand("study", "error against cost of a scene: runs every combination of the varied fields");
  line.app.add_subcommand("bench", "run a benchmark (NAME [--json FILE]); without a name, list them");
  line.app.add_subcommand("validate", "run a validation case (NAME [--json FILE]); without a name, list them");
}

Words verb_names(const CLI::App& app) {
  Words names;
  for (const CLI::App* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

/// One line for a command line that CLI11 refuses, with the nearest option where an unknown one was given.
report::SceneError refusal(const CLI::App& app, const CLI::ParseError& error, const Words& arguments) {
  const auto chosen = app.get_subcommands();
  const std::string verb = chosen.empty() ? "" : chosen.front()->get_name();
  std::string sentence = error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError) && !chosen.empty()) {
    Words options;
    for (const CLI::Option* option : chosen.front()->get_options()) options.push_back(option->get_name());
    for (const std::string& argument : arguments) {
      const std::string written = argument.substr(0, argument.find('='));
      if (!written.starts_with("--") || std::find(options.begin(), options.end(), written) != options.end()) continue;
      return {verb, "there is no option " + written, scene::suggestion(written, options, "the options are")};
    }
  }
  return {verb, sentence, "`couplet " + verb + (verb.empty() ? "" : " ") + "--help` shows what there is"};
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CommandLine line;
  line.app.require_subcommand(1);
  add_verbs_that_run(line);
  add_verbs_that_tell(line);
  add_verbs_that_hand_over(line);

  const Words arguments(argv + std::min(argc, 1), argv + argc);
  if (arguments.empty()) {
    std::fputs(line.app.help().c_str(), stdout);
    throw report::SceneError("", "no verb was given", "the verbs are listed above");
  }
  const Words verbs = verb_names(line.app);
  const std::string& verb = arguments.front();
  if (verb == "study" || verb == "bench" || verb == "validate") {
    return hand_over(verb, {arguments.begin() + 1, arguments.end()});
  }
  if (!verb.starts_with("-") && std::find(verbs.begin(), verbs.end(), verb) == verbs.end()) {
    throw report::SceneError("", "there is no verb " + verb, scene::suggestion(verb, verbs, "the verbs are"));
  }
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return line.app.exit(help);
  } catch (const CLI::ParseError& error) {
    throw refusal(line.app, error, arguments);
  }
  return line.action();
}

}  // namespace couplet::launcher
