#pragma once
// Nodes that stand at the same place.

#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// For every node the smallest number among the nodes that stand within `tolerance` [m] of it, itself included:
/// (n_nodes). Chains are followed to their end, so that all nodes of one place have the same answer.
std::vector<Index> find_coincident_nodes(const NodePositions& position, double tolerance);

/// 1e-7 of the diagonal of the box around the nodes [m]: far above rounding, far below any element.
double coincidence_tolerance(const NodePositions& position);

}  // namespace couplet::solid
