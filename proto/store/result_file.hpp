#pragma once
// Fields over time that ParaView opens with one click: an HDF5 file and an XDMF file beside it.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "proto/store/hdf5_file.hpp"
#include "proto/surface/surface_field.hpp"

namespace couplet::store {

enum class CellShape { polyline, hexahedron20 };

/// Node order of hexahedron20: XDMF's Hexahedron_20 (that of VTK): 8 corners, 4 edges of the bottom, 4 of the top, 4 upright.
struct ResultMesh {
  CellShape shape;
  surface::NodeArray node_position;     // (n_nodes, 3) reference position [m]
  std::vector<std::int64_t> cell_node;  // (n_cells * nodes per cell)
};

/// Appends states; after every append both files are complete on disk, so a run that is killed leaves readable results.
class ResultWriter {
 public:
  /// Writes results/NAME.h5 and results/NAME.xmf anew.
  ResultWriter(const std::filesystem::path& results_folder, const std::string& name, const ResultMesh& mesh);
  /// Continues an existing pair; states later than `time` are dropped.
  static ResultWriter continue_from(const std::filesystem::path& results_folder, const std::string& name,
                                    const ResultMesh& mesh, double time);
  ~ResultWriter();
  ResultWriter(ResultWriter&&) noexcept;

  /// Node fields at a time, (n_nodes, 1 or 3), stored in single precision. A field named displacement moves the picture: nodes are
  /// drawn at their moved position.
  void append(double time, const surface::FieldSet& fields);

 private:
  struct State;
  explicit ResultWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace couplet::store
