#pragma once
// What a run of a scene would cost the flow, before it is run.

#include <vector>

#include "proto/participant/participant.hpp"

namespace couplet::flow {

/// stations [1]; when the surface is known faces [1]; then, or when there is none, seconds_per_solve [s] and
/// memory_bytes [1]. Throws SceneError.
std::vector<participant::NamedNumber> estimate_flow(const participant::OpenRequest& request);

}  // namespace couplet::flow
