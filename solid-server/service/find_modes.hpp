#pragma once
// solid-server modes: free vibration of the bodies of a scene.

#include "proto/participant/participant.hpp"
#include "proto/participant/server_program.hpp"

namespace couplet::solid {

/// Prints a table of the modes that scene.solid.modes asks for: frequency, shares of the directions, symmetry about the
/// middle planes asked for, residual. With a run folder also modes.csv and results/modes.xmf, in which the n-th state
/// (at time n) shows the n-th shape, its largest displacement a tenth of the largest extent of the bodies.
void find_modes(const participant::OpenRequest& request, const participant::ServerOptions& options);

}  // namespace couplet::solid
