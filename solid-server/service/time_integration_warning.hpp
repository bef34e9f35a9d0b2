#pragma once
// Choices of a scene that are allowed and may end badly.

#include <string>

#include "couplet/v1/scene.pb.h"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// One sentence with advice when a long run has no numerical dissipation; else empty.
std::string time_integration_warning(const v1::Scene& scene, TimeMethod method);

}  // namespace couplet::solid
