#include "deploy/launcher/batch_job.hpp"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "deploy/launcher/checked_scene.hpp"
#include "deploy/launcher/external_program.hpp"
#include "deploy/launcher/shell_words.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::launcher {
namespace {

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

/// Lines of the shell that write the file of hosts when the job knows its nodes, and the keys if there are none yet.
/// The job itself runs on the first node, which is one of the flow: so Open MPI starts its ranks as Slurm wants it.
std::string hosts_of_job(int n_cpus, const std::string& network, bool has_solid, const std::string& out,
                         const Installation& installation) {
  std::ostringstream text;
  text << "cpus=" << n_cpus << "\nhosts=" << quoted(out + "/hosts.txtpb") << "\nkeys=" << quoted(out + "/keys")
       << "\nmore=" << quoted(network.empty() ? "" : "network: \"" + network + "\"") << R"(
nodes=($(scontrol show hostnames "$SLURM_JOB_NODELIST"))
last=${nodes[-1]}
)" << (has_solid ? "unset 'nodes[-1]'\n" : "")
       << R"({
  printf 'flow { name: "%s"  slots: '"$cpus"' }\n' "${nodes[@]}"
  printf 'solid { name: "%s"  threads: '"$cpus"' }\ncoupler { name: "%s" }\n' "$last" "$last"
  printf '%s\n' 'remote_shell: "srun --overlap --nodes=1 --ntasks=1 -w {host} bash -c {command}"' "$more"
} > "$hosts"
)"
       << "[ -e \"$keys\" ] || " << quoted(installation.program("couplet")) << " keys \"$keys\"\n";
  return text.str();
}

}  // namespace

std::string batch_job_text(const BatchOptions& options, bool has_solid, const Installation& installation) {
  const std::string out = full_name(options.run.out);
  const bool is_spread = options.nodes > 1;
  const int n_needed = std::max(1, options.run.flow_ranks) + options.run.solid_threads;
  const int n_cpus = options.cpus > 0 ? options.cpus : std::max(2, n_needed);
  std::ostringstream text;
  text << "#!/bin/bash\n#SBATCH --job-name=couplet-" << options.run.out.filename().string()
       << "\n#SBATCH --nodes=" << options.nodes
       << (is_spread ? "\n#SBATCH --ntasks-per-node=" : "\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=") << n_cpus
       << "\n#SBATCH --output=" << quoted(out + "/slurm-%j.txt")
       << "\n#SBATCH --signal=B:TERM@60\n";  // a minute before the time is up the run ends in good order
  if (!options.partition.empty()) text << "#SBATCH --partition=" << options.partition << "\n";
  if (!options.time_limit.empty()) text << "#SBATCH --time=" << options.time_limit << "\n";
  if (is_spread) text << hosts_of_job(n_cpus, options.network, has_solid, out, installation);
  text << "exec";
  for (const std::string& word : run_command(options.run, installation)) text << ' ' << quoted(word);
  if (is_spread) text << " --hosts \"$hosts\" --keys \"$keys\"";
  text << "\n";
  return text.str();
}

void submit_batch_job(const BatchOptions& options) {
  const scene::SceneFile file = read_checked_scene(options.run.scene, options.run.settings);
  const store::RunFolder folder = store::make_run_folder(options.run.out);
  const std::string job = full_name(folder.path / "job.sh");
  store::write_file(job, batch_job_text(options, file.scene.has_solid(), find_installation()));
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
