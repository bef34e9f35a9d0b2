#pragma once
// A participant on its own: prescribed loads, the same files as a coupled run.

#include <string>

#include "proto/participant/participant.hpp"

namespace couplet::participant {

struct AloneOptions {
  std::string program;      // "solid-server"
  std::string scene_path;   // for summary.json
  std::string run_folder;   // is made
  std::string resume_from;  // run folder or checkpoint folder to continue from; empty: start at t = 0
  std::int64_t steps = 0;   // stop after this many steps; 0: at the end of the scene
  bool quiet = false;
};

/// Runs the scene from its start to its end with no partner; fields that the participant needs are zero.
void run_alone(Participant& participant, const v1::Scene& scene, const AloneOptions& options);

}  // namespace couplet::participant
