#pragma once
// How states of fields lie in the HDF5 files of a result: what writer and reader must agree on.
//
//   NAME.h5, NAME.0001.h5, ...   blocks of states, in order of time; the first holds the mesh too
//     mesh/position   double (n_nodes, 3)       reference position [m]
//     mesh/cell       integer (n_cells, n)      nodes of the cells; a polyline is stored as its segments; of mixed
//     cells
//                                               (any, 1): the number of its shape (cell_code) and its nodes for each
//     mesh/shape      text                      polyline, hexahedron20, hexahedron8, tetrahedron10, mixed, triangle or
//                                               quadrilateral
//     mesh/cell_numbers text                    names of the integers that each cell has, separated by commas
//     mesh/NAME       integer (n_cells, 1)      one of them
//     field_names     text                      of nodes, separated by commas
//     cell_field_names text                     of cells, likewise
//     n_states        integer (1)               states that are complete in this block
//     time            double (n_slots)          [s]
//     state/I/NAME    float (n_nodes or n_cells, n)
//                                               field NAME of the block's state I = 0, 1, ...; n = 9: a tensor row by
//                                               row, since readers disagree on the order of six numbers
//     state/I/position float (n_nodes, 3)       moved nodes, where the fields have a displacement

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/store/result_file.hpp"

namespace couplet::store {

/// What the files call a shape, and how many columns their arrays of cells have.
struct CellLayout {
  CellShape shape;
  const char* name;
  std::int64_t n_columns;
};

inline constexpr std::array<CellLayout, 7> cell_layouts = {{{CellShape::polyline, "polyline", 2},
                                                            {CellShape::hexahedron20, "hexahedron20", 20},
                                                            {CellShape::hexahedron8, "hexahedron8", 8},
                                                            {CellShape::tetrahedron10, "tetrahedron10", 10},
                                                            {CellShape::mixed, "mixed", 1},
                                                            {CellShape::triangle, "triangle", 3},
                                                            {CellShape::quadrilateral, "quadrilateral", 4}}};

inline const CellLayout& layout_of(CellShape shape) {
  return cell_layouts[static_cast<std::size_t>(shape)];
}

/// The number of cells in an array of cells.
std::int64_t count_cells(CellShape shape, const std::vector<std::int64_t>& cell_node);

inline std::string block_file_name(const std::string& name, int block) {
  if (block == 0) return name + ".h5";
  const std::string number = std::to_string(block);
  return name + "." + std::string(number.size() < 4 ? 4 - number.size() : 0, '0') + number + ".h5";
}

/// The moved nodes among the arrays of a state.
inline constexpr const char* moved_position = "position";

inline std::string mesh_dataset(const std::string& name) {
  return "mesh/" + name;
}

inline std::string state_dataset(std::int64_t slot, const std::string& field) {
  return "state/" + std::to_string(slot) + "/" + field;
}

}  // namespace couplet::store
