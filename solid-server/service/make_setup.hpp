#pragma once
// From the solid part of a checked scene to plain values.

#include "couplet/v1/scene.pb.h"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// The only place that turns messages into a body and what acts on it. Throws SceneError.
SolidSetup make_setup(const v1::Solid& solid);

/// How many threads a body of this size is worth when `wanted` (0: all cores) are offered. Results do not depend on it.
int worthwhile_threads(int wanted, Index n_elements);

}  // namespace couplet::solid
