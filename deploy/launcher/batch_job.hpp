#pragma once
// The verb `submit`: a run as a batch job of Slurm, inside one node.

#include <string>

#include "deploy/launcher/installation.hpp"
#include "deploy/launcher/run_options.hpp"

namespace couplet::launcher {

struct BatchOptions {
  RunOptions run;
  std::string partition;   // empty: that of the site
  std::string time_limit;  // as sbatch takes it; empty: that of the site
  int cpus = 0;            // 0: flow ranks + solid threads, at least 2
  bool dry_run = false;    // write the job but do not submit it
};

/// The text of the job. All paths in it are absolute.
std::string batch_job_text(const BatchOptions& options, const Installation& installation);

/// Writes OUT/job.sh and submits it with sbatch; prints where it is. Throws SceneError, or FileError when sbatch is
/// missing or refuses.
void submit_batch_job(const BatchOptions& options);

}  // namespace couplet::launcher
