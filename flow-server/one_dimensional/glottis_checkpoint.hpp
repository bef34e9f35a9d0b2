#pragma once
// The accepted state of the glottal flow as a file.

#include <cstdint>
#include <filesystem>

#include "flow-server/one_dimensional/glottal_flow.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

struct GlottisCheckpoint {
  double time = 0;  // [s]
  GlottalHistory history;
  surface::NodeArray force;  // (n_nodes, 3) [N]
  double n_clipped = 0;
};

/// Throws FileError.
void write_glottis_checkpoint(const std::filesystem::path& path, const GlottisCheckpoint& state);

/// Throws FileError when the file is not such a checkpoint or belongs to another number of stations or nodes.
GlottisCheckpoint read_glottis_checkpoint(const std::filesystem::path& path, int n_stations, std::int64_t n_nodes);

}  // namespace couplet::flow
