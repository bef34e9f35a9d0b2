#pragma once
// The verb `run`: from a scene to a folder with its results.

#include "deploy/launcher/run_options.hpp"

namespace couplet::launcher {

/// Checks the scene, starts what it needs, watches it to its end, writes the report. Returns the exit code of the run;
/// throws what keeps it from starting.
int run_scene(const RunOptions& options);

}  // namespace couplet::launcher
