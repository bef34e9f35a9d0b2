#pragma once
// From materials in a scene to laws.

#include "couplet/v1/material.pb.h"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

/// Throws SceneError naming `where` when the message names no law.
Material make_material(const v1::Material& material, const std::string& where);

}  // namespace couplet::solid
