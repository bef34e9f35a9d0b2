#pragma once
// From the words of a scene to the plain values of the Navier-Stokes flow.

#include <filesystem>

#include "couplet/v1/scene.pb.h"
#include "flow-server/navier_stokes/navier_stokes_model.hpp"

namespace couplet::flow {

/// Relative paths start at `scene_folder`. `solid`: the wetted surface of the solid, where there is one. Throws
/// SceneError where the scene asks for something that cannot be.
NavierStokesOptions make_navier_stokes(const v1::Scene& scene, const std::filesystem::path& scene_folder,
                                       const std::optional<surface::SurfaceMesh>& solid = {});

}  // namespace couplet::flow
