#pragma once
// Which components of which nodes cannot move.

#include <string>
#include <vector>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// Nodes of a surface keep their place along one axis (0, 1, 2) and slide along the others.
struct SymmetrySurface {
  std::string surface;
  int axis = 0;
};

struct Supports {
  std::vector<std::string> fixed;  // surfaces whose nodes do not move
  std::vector<SymmetrySurface> symmetry;
};

/// 1/m of each node and component, 0 where a support holds it: what multiplies a force to give an acceleration.
/// (n_nodes, 4) [1/kg]. Throws SceneError for an unknown surface.
NodeVectors inverse_mass(const SolidMesh& mesh, const Eigen::VectorXd& mass, const Supports& supports);

}  // namespace couplet::solid
