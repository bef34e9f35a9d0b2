#pragma once
// What a run of a scene will need from the solid.

#include "proto/participant/participant.hpp"

namespace couplet::solid {

/// Nodes, degrees of freedom, elements, memory, stable step, substeps of a coupling step, and the time that a substep
/// takes, measured on this machine by a few of them; from that the time of the whole run with one solve a step.
std::vector<participant::NamedNumber> estimate_solid(const participant::OpenRequest& request, int threads);

}  // namespace couplet::solid
