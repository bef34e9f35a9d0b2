#include "solid-server/element/mass.hpp"

#include <Eigen/LU>

#include "solid-server/element/deformation.hpp"

namespace couplet::solid {

Eigen::VectorXd lumped_mass(const SolidMesh& mesh, const std::vector<double>& density) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.n_nodes());
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    const ElementBlock& block = mesh.block[b];
    const auto points = tabulate(block.shape, element_quadrature(block.shape, n_mass_points(block.shape)));
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      const ElementVectors position = at_element(mesh.node_position, nodes);
      ShapeValues<max_element_nodes> diagonal = ShapeValues<max_element_nodes>::Zero(position.rows());
      double total = 0;
      for (const TabulatedPoint& point : points) {
        const double mass_at_point = density[b] * jacobian(position, point).determinant() * point.weight;
        diagonal += mass_at_point * point.value.cwiseAbs2();
        total += mass_at_point;
      }
      diagonal *= total / diagonal.sum();
      for (std::size_t a = 0; a < nodes.size(); ++a) mass[nodes[a]] += diagonal[static_cast<Eigen::Index>(a)];
    }
  }
  return mass;
}

Eigen::VectorXd row_sums_of_mass(const SolidMesh& mesh, const std::vector<double>& density) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(mesh.n_nodes());
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    const ElementBlock& block = mesh.block[b];
    const auto points = tabulate(block.shape, element_quadrature(block.shape, n_mass_points(block.shape)));
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      const ElementVectors position = at_element(mesh.node_position, nodes);
      for (const TabulatedPoint& point : points) {
        const double mass_at_point = density[b] * jacobian(position, point).determinant() * point.weight;
        for (std::size_t a = 0; a < nodes.size(); ++a)
          sums[nodes[a]] += mass_at_point * point.value[static_cast<Eigen::Index>(a)];
      }
    }
  }
  return sums;
}

}  // namespace couplet::solid
