#pragma once
// Both surfaces have the same nodes, in any order.

#include <optional>
#include <string>

#include "coupler/mapping/interpolation.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

struct MatchingResult {
  std::optional<Interpolation> interpolation;  // empty: the surfaces do not match
  std::string first_unmatched;                 // then this says which node has no partner
  bool is_identity = false;                    // the order is the same too
};

/// Nodes are partners within 1e-6 of the diagonal of the box around the solid's surface.
MatchingResult match_nodes(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid);

}  // namespace couplet::coupling
