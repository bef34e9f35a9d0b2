#pragma once
// The accepted state of the flow as a file, written and read by all ranks together.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/flow_state.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_geometry.hpp"
#include "flow-server/immersed/body_surfaces.hpp"

namespace couplet::flow {

/// What belongs to a state of the flow beside its fields where there are bodies, of the whole grid.
struct StoredBodies {
  std::vector<std::string> names;
  std::optional<NodalMotion> motion;  // of the body that is moved from outside

  /// The pressure of a part of a cut cell whose place in the fields belongs to another part.
  struct Part {
    Triple cell;        // of the grid
    int number = 0;     // among the parts of its cell
    double pressure{};  // [Pa]
  };
  std::vector<Part> parts;

  std::vector<BodyGeometry::ChangedFace> changed_faces;  // indices of the grid
};

/// Collective. In full precision, cells in the order of the whole grid: any number of ranks can read it. `motion`: of
/// the body that is moved from outside, if there is one. Throws FileError.
void write_navier_stokes_checkpoint(const std::filesystem::path& path, const FlowState& state,
                                    const StretchedGrid& grid, const BlockDecomposition& decomposition,
                                    const std::optional<NodalMotion>& motion = {});

/// Collective. `state` has the shape of a state of this grid; its ghosts and its bodies are left as they are. Returns,
/// on every rank, what is stored of bodies: without names where there were none. Throws FileError when the file belongs
/// to another grid or is none.
StoredBodies read_navier_stokes_checkpoint(const std::filesystem::path& path, const StretchedGrid& grid,
                                           const BlockDecomposition& decomposition, FlowState& state);

/// What is stored of bodies into those of a state, which stand where they stood then. Parts of cells of this rank that
/// are not stored keep the pressure they have; returns how many there are.
int restore_bodies(const StoredBodies& stored, const StretchedGrid& grid, const BlockDecomposition& decomposition,
                   FlowState& state);

}  // namespace couplet::flow
