#pragma once
// From the words of a scene to a flow model.

#include <mpi.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "couplet/v1/scene.pb.h"
#include "flow-server/flow_model.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

/// Relative paths start at `scene_folder`. `surface`: the wetted surface that the solid offers; none in a scene without
/// a solid. `ranks`: those that make the model together; MPI_COMM_NULL in a process without MPI. Throws SceneError
/// where the scene asks for something that cannot be, PeerError when the surface does not fit the model.
std::unique_ptr<FlowModel> make_flow_model(const v1::Scene& scene, const std::filesystem::path& scene_folder,
                                           const std::optional<surface::SurfaceMesh>& surface, MPI_Comm ranks);

}  // namespace couplet::flow
