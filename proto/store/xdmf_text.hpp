#pragma once
// The text of an XDMF 3 file, which tells ParaView what the arrays of the HDF5 files mean.

#include <cstdint>
#include <string>
#include <vector>

#include "proto/store/result_file.hpp"

namespace couplet::store {

struct XdmfField {
  std::string name;
  std::int64_t n_components = 1;  // 1, 3 or 9, a tensor
  bool is_of_cells = false;       // else of nodes
};

/// What all states of a result share.
struct XdmfMesh {
  CellShape shape;
  std::int64_t n_nodes = 0;
  std::int64_t n_cells = 0;
  std::int64_t n_cell_nodes = 0;              // entries of the array of cells
  std::string file;                           // that holds mesh/position and mesh/cell, relative to the XDMF file
  std::vector<std::string> cell_number = {};  // names of the integers that each cell has, mesh/NAME there
};

std::string xdmf_start(const std::string& name);
/// One state, whose arrays are FILE:/state/SLOT/FIELD.
std::string xdmf_state(const XdmfMesh& mesh, const std::vector<XdmfField>& fields, bool is_moving, double time,
                       const std::string& file, std::int64_t slot);
std::string xdmf_end();

}  // namespace couplet::store
