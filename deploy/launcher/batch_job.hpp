#pragma once
// The verb `submit`: a run as a batch job of Slurm, on one node or on several.

#include <string>

#include "deploy/launcher/installation.hpp"
#include "deploy/launcher/run_options.hpp"

namespace couplet::launcher {

struct BatchOptions {
  RunOptions run;
  std::string partition;   // empty: that of the site
  std::string time_limit;  // as sbatch takes it; empty: that of the site
  int nodes = 1;           // with several the last one is that of solid and coupler, if the scene has a solid
  int cpus = 0;            // of each node; 0: flow ranks + solid threads, at least 2
  std::string network;     // that the ranks of the flow use; empty: as Open MPI finds it
  bool dry_run = false;    // write the job but do not submit it
};

/// The text of the job. All paths in it are absolute.
std::string batch_job_text(const BatchOptions& options, bool has_solid, const Installation& installation);

/// Writes OUT/job.sh and submits it with sbatch; prints where it is. Throws SceneError, or FileError when sbatch is
/// missing or refuses.
void submit_batch_job(const BatchOptions& options);

}  // namespace couplet::launcher
