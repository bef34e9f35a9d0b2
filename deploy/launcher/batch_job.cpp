#include "deploy/launcher/batch_job.hpp"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "deploy/launcher/checked_scene.hpp"
#include "deploy/launcher/external_program.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::launcher {
namespace {

/// A word as the shell reads it back, whatever is in it.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'') {
      text.append("'\\''");
    } else {
      text.push_back(c);
    }
  }
  text.push_back('\'');
  return text;
}

std::string full_name(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

std::vector<std::string> run_command(const RunOptions& run, const Installation& installation) {
  std::vector<std::string> words{installation.program("couplet"), "run", full_name(run.scene), "--out",
                                 full_name(run.out)};
  const auto add = [&](const std::string& option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  for (const std::string& setting : run.settings) add("--set", setting);
  if (run.flow_ranks > 0) add("--flow-ranks", std::to_string(run.flow_ranks));
  if (run.solid_threads > 0) add("--solid-threads", std::to_string(run.solid_threads));
  if (!run.transport.empty()) add("--transport", run.transport);
  if (!run.own_flow.empty()) add("--flow", run.own_flow);
  if (!run.own_solid.empty()) add("--solid", run.own_solid);
  if (!run.resume.empty()) add("--resume", full_name(run.resume));
  if (run.steps > 0) add("--steps", std::to_string(run.steps));
  if (run.force) words.push_back("--force");
  if (!run.report) words.push_back("--no-report");
  return words;
}

}  // namespace

std::string batch_job_text(const BatchOptions& options, const Installation& installation) {
  const std::string out = full_name(options.run.out);
  const int n_needed = std::max(1, options.run.flow_ranks) + options.run.solid_threads;
  const int n_cpus = options.cpus > 0 ? options.cpus : std::max(2, n_needed);
  std::ostringstream text;
  text << "#!/bin/bash\n#SBATCH --job-name=couplet-" << options.run.out.filename().string()
       << "\n#SBATCH --nodes=1\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=" << n_cpus
       << "\n#SBATCH --output=" << quoted(out + "/slurm-%j.txt")
       << "\n#SBATCH --signal=B:TERM@60\n";  // a minute before the time is up the run ends in good order
  if (!options.partition.empty()) text << "#SBATCH --partition=" << options.partition << "\n";
  if (!options.time_limit.empty()) text << "#SBATCH --time=" << options.time_limit << "\n";
  text << "exec";
  for (const std::string& word : run_command(options.run, installation)) text << ' ' << quoted(word);
  text << "\n";
  return text.str();
}

void submit_batch_job(const BatchOptions& options) {
  read_checked_scene(options.run.scene, options.run.settings);
  const store::RunFolder folder = store::make_run_folder(options.run.out);
  const std::string job = full_name(folder.path / "job.sh");
  store::write_file(job, batch_job_text(options, find_installation()));
  std::printf("wrote %s\n", job.c_str());
  if (options.dry_run) return;
  const ProgramResult result = run_and_catch({"sbatch", job});
  if (result.exit_code != 0) {
    throw report::FileError("sbatch", "did not take the job: " + result.errors.substr(0, result.errors.find('\n')),
                            "mend it, or submit " + job + " yourself");
  }
  std::printf("%s", result.output.c_str());
}

}  // namespace couplet::launcher
