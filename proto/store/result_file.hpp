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

enum class CellShape { polyline, hexahedron20, hexahedron8, tetrahedron10, mixed, triangle, quadrilateral };

/// Node orders are those of XDMF's Hexahedron_20, Hexahedron, Tetrahedron_10 and so on (those of VTK): corners, then
/// midside nodes; of hexahedra 4 edges of the bottom, 4 of the top, 4 upright; of tetrahedra edges 0-1, 1-2, 2-0, 0-3,
/// 1-3, 2-3.
struct ResultMesh {
  CellShape shape;
  surface::NodeArray node_position;     // (n_nodes, 3) reference position [m]
  std::vector<std::int64_t> cell_node;  // (n_cells * nodes per cell); a polyline is one cell of any length;
                                        // mixed: each cell is its cell_code and its nodes

  /// Integers that each cell keeps for the whole run, by name: the number of its body, of its region.
  struct CellNumber {
    std::string name;
    std::vector<std::int64_t> value;  // (n_cells)
  };
  std::vector<CellNumber> cell_number = {};
};

/// The number of a shape among mixed cells: XDMF's. Not for polyline and mixed.
std::int64_t cell_code(CellShape shape);

/// Appends states, kept safe from a run that is killed: the numbers of a state go to places that are reserved in the
/// HDF5 file beforehand, so that the structure of the file never changes while somebody may kill the run or look at it.
/// When the reserved places are used up, a further file NAME.0001.h5, NAME.0002.h5, ... is made, larger than the one
/// before. NAME.xmf names every state of all of them; it is replaced as a whole after each append (from some hundred
/// states on not after each: at most one state in 256 is missing from it after a kill).
class ResultWriter {
 public:
  /// Removes what an earlier run left under this name. The files appear with the first append.
  ResultWriter(const std::filesystem::path& results_folder, const std::string& name, const ResultMesh& mesh);
  /// Continues what is there (or starts anew where nothing is); states later than `time` are dropped. Throws FileError
  /// when the files there belong to another mesh.
  static ResultWriter continue_from(const std::filesystem::path& results_folder, const std::string& name,
                                    const ResultMesh& mesh, double time);
  ~ResultWriter();
  ResultWriter(ResultWriter&&) noexcept;

  /// Fields of the nodes and of the cells at a time, (n_nodes or n_cells, n), stored in single precision: the same
  /// fields every time. n = 1, 3, or 9 for a tensor, row by row. A node field named displacement
  /// moves the picture: nodes are drawn at their moved position. Throws FileError when the disk is full.
  void append(double time, const surface::FieldSet& fields, const surface::FieldSet& cell_fields = {});

 private:
  struct State;
  explicit ResultWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace couplet::store
