#pragma once
// How states of fields lie in the HDF5 files of a result: what writer and reader must agree on.
//
//   NAME.h5, NAME.0001.h5, ...   blocks of states, in order of time; the first holds the mesh too
//     mesh/position   double (n_nodes, 3)       reference position [m]
//     mesh/cell       integer (n_cells, n)      nodes of the cells; a polyline is stored as its segments
//     mesh/shape      text                      polyline or hexahedron20
//     field_names     text                      separated by commas
//     n_states        integer (1)               states that are complete in this block
//     time            double (n_slots)          [s]
//     state/I/NAME    float (n_nodes, n)        field NAME of the block's state I = 0, 1, ...
//     state/I/position float (n_nodes, 3)       moved nodes, where the fields have a displacement

#include <cstdint>
#include <filesystem>
#include <string>

#include "proto/store/result_file.hpp"

namespace couplet::store {

inline std::int64_t nodes_per_cell(CellShape shape) {
  return shape == CellShape::polyline ? 2 : 20;
}

inline std::string block_file_name(const std::string& name, int block) {
  if (block == 0) return name + ".h5";
  const std::string number = std::to_string(block);
  return name + "." + std::string(number.size() < 4 ? 4 - number.size() : 0, '0') + number + ".h5";
}

inline std::string state_dataset(std::int64_t slot, const std::string& field) {
  return "state/" + std::to_string(slot) + "/" + field;
}

}  // namespace couplet::store
