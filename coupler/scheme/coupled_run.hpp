#pragma once
// A whole coupled run with any two participants: opens them, marches through time, leaves the files of the run.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "couplet/v1/scene.pb.h"
#include "proto/participant/participant.hpp"
#include "proto/store/summary.hpp"

namespace couplet::coupling {

struct CoupledRunOptions {
  std::string scene_path;             // for summary.json
  std::string scene_folder;           // relative paths in the scene start here
  std::filesystem::path run_folder;   // is made
  std::filesystem::path resume_from;  // run folder, checkpoint folder or one checkpoint; empty: start at t = 0
  std::int64_t steps = 0;             // accept so many steps and end; 0: go on to the end of the scene
  bool quiet = false;
  std::function<bool()> should_stop;  // asked between steps: end in good order
};

/// Returns the summary that was written. On any failure results, history and summary are complete up to the last
/// accepted step, both participants have been closed, and the failure is thrown on.
store::Summary run_coupled(participant::Participant& flow, participant::Participant& solid, const v1::Scene& scene,
                           const CoupledRunOptions& options);

}  // namespace couplet::coupling
