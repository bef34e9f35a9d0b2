#pragma once
// From materials in a scene to laws and directions of fibres.

#include <optional>

#include "couplet/v1/material.pb.h"
#include "solid-server/material/material.hpp"
#include "solid-server/mesh/fibre_rule.hpp"

namespace couplet::solid {

/// Throws SceneError naming `where` when the message names no law.
Material make_material(const v1::Material& material, const std::string& where);

/// Nothing when the mesh itself gives the directions.
std::optional<FibreRule> make_fibre_rule(const v1::Fibres& fibres);

}  // namespace couplet::solid
