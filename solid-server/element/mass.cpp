#include "solid-server/element/mass.hpp"

#include "solid-server/element/deformation.hpp"
#include "solid-server/element/hex20.hpp"

namespace couplet::solid {

Eigen::VectorXd lumped_mass(const SolidMesh& mesh, double density) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.n_nodes());
  const auto points = element_quadrature(27);
  for (const auto& nodes : mesh.element_node) {
    const ElementVectors position = at_element(mesh.node_position, nodes);
    Eigen::Matrix<double, hex20::n_nodes, 1> diagonal = Eigen::Matrix<double, hex20::n_nodes, 1>::Zero();
    double total = 0;
    for (const QuadraturePoint& point : points) {
      const double mass_at_point = density * reference_point(position, point).volume;
      diagonal += mass_at_point * hex20::shape(point.xi).cwiseAbs2();
      total += mass_at_point;
    }
    diagonal *= total / diagonal.sum();
    for (int a = 0; a < hex20::n_nodes; ++a) mass[nodes[static_cast<std::size_t>(a)]] += diagonal[a];
  }
  return mass;
}

}  // namespace couplet::solid
