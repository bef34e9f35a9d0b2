#pragma once
// The names of surfaces and markers that each kind of mesh has.

#include <string>
#include <vector>

#include "couplet/v1/solid.pb.h"

namespace couplet::scene {

/// Empty when the body has no mesh.
std::vector<std::string> surface_names(const v1::Body& body);

/// Empty when the mesh has no markers.
std::vector<std::string> marker_names(const v1::Body& body);

}  // namespace couplet::scene
