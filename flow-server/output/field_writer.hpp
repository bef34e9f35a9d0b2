#pragma once
// Fields of the flow over time, for ParaView: each state is a file that all ranks write together.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "flow-server/output/flow_measurement.hpp"
#include "flow-server/output/parallel_file.hpp"
#include "flow-server/output/state_catalogue.hpp"

namespace couplet::flow {

/// results/flow.000000.h5, flow.000001.h5, ..., one for each state:
///   time                  [s]
///   NAME/FIELD            of region NAME, (nz, ny, nx) or (nz, ny, nx, 3) at cell centres
///   body/NAME/FIELD       of body NAME, (n_corners) or (n_corners, 3) at the corners of its surface
/// results/flow.h5, which shows all states as one file:
///   grid/NAME/x, y, z     faces of the picture's cells [m]
///   body/NAME/triangle    (n_triangles, 3) corners
///   state/000000          stands for all that is in flow.000000.h5
/// and, for each region results/NAME.xmf, for each body results/body.NAME.xmf. A state is written by all ranks under
/// another name and gets its own when it is complete; then flow.h5 and the .xmf are replaced as a whole.
class FieldWriter {
 public:
  /// Collective. Where files are there and time > 0 they are continued: states later than `time` are dropped. Throws
  /// FileError.
  FieldWriter(const std::filesystem::path& results_folder, const StretchedGrid& grid,
              const BlockDecomposition& decomposition, std::vector<FieldRegion> regions, double time,
              std::vector<StoredSurface> surfaces = {});

  /// Collective. `surfaces`: values of each. Throws FileError.
  void append(const FlowPart& part, std::span<const SurfaceValues> surfaces = {});

 private:
  std::filesystem::path folder_;
  const BlockDecomposition& decomposition_;
  std::vector<FieldRegion> regions_;
  std::vector<StoredSurface> surfaces_;
  std::unique_ptr<StateCatalogue> catalogue_;  // on the first rank
  std::int64_t next_number_ = 0;
};

}  // namespace couplet::flow
