#pragma once
// The idealised vocal fold of uniform section, meshed by one structured block: x along the flow, y from the lateral
// wall, z along the length.

#include "solid-server/mesh/parametric/fold_section.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct VocalFoldShape {
  FoldSectionShape section;
  double length = 0.020;  // L: of the whole fold along z [m]
  double x_offset = 0;    // x of the upstream end A [m]
  std::array<int, 3> n_elements = {6, 9,
                                   12};  // along the flow, from the wall to the medial face, along the whole length
  bool half_length = false;              // keep z from 0 to L/2
};

/// The four sides of the block in the section are the wall A-E, the inferior face A-B1, the superior face C2-E, and the
/// medial face B1-C2, which includes both fillets. Interior nodes are placed by transfinite interpolation and Laplace
/// smoothing; midside nodes on the inferior face and on the fillets stand on their arcs.
///
/// Surfaces: lateral (y = 0), inferior, medial, superior, anterior (z = 0), posterior (z = L, or the cut at L/2).
/// Markers at mid length: inferior_middle (half the arc from A to B1), B1, B2, medial_middle, C1,
/// superior_fillet_middle, C2. With five or more half elements along the flow (three elements) and an even count along
/// the length each is a node; where a coarser mesh has no node there, the nearest node of the inferior, medial and
/// superior faces takes its place. Throws SceneError when the section is impossible, or when half_length meets an odd
/// count along the length.
SolidMesh make_vocal_fold_mesh(const VocalFoldShape& shape);

}  // namespace couplet::solid
