#pragma once
// On how many MPI ranks the flow of a scene runs.

#include <thread>

#include "couplet/v1/scene.pb.h"
#include "deploy/launcher/installation.hpp"
#include "deploy/launcher/run_options.hpp"

namespace couplet::launcher {

/// As many as the scene has blocks; otherwise as the user says; otherwise one for each core, but no more than share the
/// cells well. One-dimensional flow runs on one. Throws SceneError where scene and user contradict each other.
int choose_flow_ranks(const v1::Scene& scene, const RunOptions& options, const Installation& installation,
                      int n_cores = static_cast<int>(std::thread::hardware_concurrency()));

/// The last part of that choice: a number that can be cut into blocks, a product of twos and threes.
int ranks_for_cells(double n_cells, int n_cores);

}  // namespace couplet::launcher
