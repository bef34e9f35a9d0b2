#pragma once
// Which components of which nodes are free to move.

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// True where a component (x, y, z) of a node is free, false where a support or a prescribed motion holds it,
/// (n_nodes, 3).
using FreeComponents = Eigen::Array<bool, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Those whose inverse mass (supports.hpp) is not 0.
inline FreeComponents free_components(const NodeVectors& inverse_mass) {
  return inverse_mass.leftCols<3>().array() > 0;
}

}  // namespace couplet::solid
