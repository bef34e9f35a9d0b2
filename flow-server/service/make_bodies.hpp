#pragma once
// From the words of a scene to the bodies in the flow.

#include <filesystem>
#include <optional>
#include <vector>

#include "couplet/v1/navier_stokes.pb.h"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_setup.hpp"

namespace couplet::flow {

/// In the order of the scene. `solid`: the wetted surface of the solid, where there is one. Files of surfaces are read,
/// their paths starting at `scene_folder`. `time_step` [s] sets the interval over which formulas of motion are
/// differentiated. Throws SceneError, or FileError for a file.
std::vector<BodySetup> make_bodies(const v1::NavierStokes& model, const StretchedGrid& grid, double time_step,
                                   const std::filesystem::path& scene_folder,
                                   const std::optional<surface::SurfaceMesh>& solid = {});

/// The one that is moved by the solid.
std::optional<int> coupled_body(const v1::NavierStokes& model);

}  // namespace couplet::flow
