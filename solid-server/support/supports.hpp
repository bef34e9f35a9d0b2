#pragma once
// Which components of which nodes cannot move.

#include <string>
#include <vector>

#include "solid-server/support/prescribed_motion.hpp"

namespace couplet::solid {

/// Nodes of a surface keep their place along one axis (0, 1, 2) and slide along the others.
struct SymmetrySurface {
  std::string surface;
  int axis = 0;
};

struct Supports {
  std::vector<std::string> fixed;  // surfaces whose nodes do not move
  std::vector<SymmetrySurface> symmetry;
  std::vector<PrescribedMotion> prescribed = {};
};

/// A named support, and the components that it holds: one for each name, which may hold axes by several motions. A
/// component that several name belongs to the first: prescribed motions come before fixed surfaces and those before
/// symmetry surfaces, in the order of the scene.
struct SupportComponents {
  std::string name;
  std::vector<HeldMotion::Component> components;
};
std::vector<SupportComponents> support_components(const SolidMesh& mesh, const Supports& supports);

/// 1/m of each node and component, 0 where a support holds it: what multiplies a force to give an acceleration.
/// (n_nodes, 4) [1/kg]. Throws SceneError for an unknown surface.
NodeVectors inverse_mass(const SolidMesh& mesh, const Eigen::VectorXd& mass, const Supports& supports);

}  // namespace couplet::solid
