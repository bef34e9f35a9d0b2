#pragma once
// Loads whose direction does not follow the body: tractions, gravity, forces on nodes.

#include <functional>
#include <string>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

using VectorOverTime = std::function<Eigen::Vector3d(double)>;  // of the time [s]

/// A force per area at rest on a surface.
struct Traction {
  std::string surface;
  VectorOverTime value;  // [Pa]
};

/// A force on each of the nodes of a surface, a node set or a marker.
struct NodeForce {
  std::string nodes;
  VectorOverTime value;  // [N]
};

/// f_a = weight_a value(t): what all of them come down to.
struct DeadLoad {
  std::vector<Index> node;
  std::vector<double> weight;  // of each node: [m^2] of a traction, [kg] of an acceleration, 1 of a force
  VectorOverTime value;
};

/// weight_a = integral of N_a over the surface at rest. Throws SceneError for an unknown surface.
DeadLoad make_dead_load(const SolidMesh& mesh, const Traction& traction, const std::string& where);
/// Throws SceneError for an unknown name.
DeadLoad make_dead_load(const SolidMesh& mesh, const NodeForce& force, const std::string& where);
/// Gravity and other accelerations of the whole: weight_a = the mass of the node in the mass matrix in use.
DeadLoad make_body_force(const Eigen::VectorXd& node_mass, const VectorOverTime& acceleration);

}  // namespace couplet::solid
