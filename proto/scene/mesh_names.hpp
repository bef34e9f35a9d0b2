#pragma once
// The names of surfaces and markers that each kind of mesh has.

#include <string>
#include <vector>

#include "couplet/v1/solid.pb.h"

namespace couplet::scene {

/// Empty when the body has no mesh, or one from a file.
std::vector<std::string> surface_names(const v1::Body& body);

/// Empty when the mesh has no markers.
std::vector<std::string> marker_names(const v1::Body& body);

/// Empty when the mesh has no named sets of nodes beside its surfaces.
std::vector<std::string> node_set_names(const v1::Body& body);

/// Empty when the mesh is of one piece.
std::vector<std::string> region_names(const v1::Body& body);

/// Whether the names are known only to the file of the mesh: they cannot be checked before the run.
bool has_own_names(const v1::Body& body);

}  // namespace couplet::scene
