#pragma once
// The nodes whose motion a body gives to others.

#include "couplet/v1/output.pb.h"
#include "solid-server/mesh/wetted_surface.hpp"

namespace couplet::solid {

/// Nodes of the mesh and the surface that they form for others, in the same order.
struct OfferedSurface {
  surface::SurfaceMesh surface;
  std::vector<Index> solid_node;
};

/// A flow needs the whole wetted surface.
OfferedSurface offer_wetted(const WettedSurface& wetted);

/// Alone, only probes look at the motion: the markers of the mesh and the nodes nearest to the probes' positions,
/// without faces.
OfferedSurface offer_probed(const SolidMesh& mesh, const v1::Output& output);

}  // namespace couplet::solid
