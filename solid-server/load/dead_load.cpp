#include "solid-server/load/dead_load.hpp"

#include <Eigen/Geometry>
#include <numeric>

#include "solid-server/element/quadrature.hpp"
#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {

DeadLoad make_dead_load(const SolidMesh& mesh, const Traction& traction, const std::string& where) {
  const auto& faces = mesh.find_surface(traction.surface, where);
  std::map<Index, double> weight;
  for (const ElementFace& face : faces) {
    const FaceNodes nodes = mesh.nodes_of(face);
    for (const FaceQuadraturePoint& point : face_quadrature(nodes.shape())) {
      const auto shape = shape_values(nodes.shape(), point.xi);
      const auto gradient = shape_gradient(nodes.shape(), point.xi);
      Eigen::Matrix<double, 2, 3> tangent = Eigen::Matrix<double, 2, 3>::Zero();  // X,xi and X,eta
      for (std::size_t a = 0; a < nodes.size(); ++a)
        tangent += gradient.row(static_cast<Eigen::Index>(a)).transpose() * mesh.node_position.row(nodes[a]);
      const double area = tangent.row(0).cross(tangent.row(1)).norm() * point.weight;
      for (std::size_t a = 0; a < nodes.size(); ++a) weight[nodes[a]] += shape[static_cast<Eigen::Index>(a)] * area;
    }
  }
  DeadLoad load;
  for (const auto& [node, area] : weight) {
    load.node.push_back(node);
    load.weight.push_back(area);
  }
  load.value = traction.value;
  return load;
}

DeadLoad make_dead_load(const SolidMesh& mesh, const NodeForce& force, const std::string& where) {
  DeadLoad load{mesh.find_nodes(force.nodes, where), {}, force.value};
  load.weight.assign(load.node.size(), 1);
  return load;
}

DeadLoad make_body_force(const Eigen::VectorXd& node_mass, const VectorOverTime& acceleration) {
  DeadLoad load;
  load.node.resize(static_cast<std::size_t>(node_mass.size()));
  std::iota(load.node.begin(), load.node.end(), 0);
  load.weight.assign(node_mass.data(), node_mass.data() + node_mass.size());
  load.value = acceleration;
  return load;
}

}  // namespace couplet::solid
