#pragma once
// From the solid part of a checked scene to plain values.

#include <filesystem>

#include "couplet/v1/scene.pb.h"
#include "solid-server/output/orifice.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// The only place that turns messages into bodies and what acts on them; mesh files start from `scene_folder`. Throws
/// SceneError.
SolidSetup make_setup(const v1::Solid& solid, const std::filesystem::path& scene_folder);

/// Throws nothing: the scene has been checked.
OrificeShape make_orifice_shape(const v1::Orifice& orifice);

/// How many threads a body of this size is worth when `wanted` (0: all cores) are offered. Results do not depend on it.
int worthwhile_threads(int wanted, const SolidSetup& setup);

}  // namespace couplet::solid
