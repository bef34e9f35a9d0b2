#pragma once
// What a run of a scene would cost the flow, before it is run.

#include <vector>

#include "proto/participant/participant.hpp"

namespace couplet::flow {

/// Of a glottis: stations [1]; when the surface is known faces [1]; then, or when there is none, seconds_per_solve [s]
/// and memory_bytes [1]. Of a Navier-Stokes flow: cells [1], cells_active [1], smallest_cell [m], convective_step_limit
/// [s] where a speed is known, explicit_diffusion_step_limit [s], seconds_per_solve [s] on one core, memory_bytes [1].
/// Throws SceneError.
std::vector<participant::NamedNumber> estimate_flow(const participant::OpenRequest& request);

}  // namespace couplet::flow
