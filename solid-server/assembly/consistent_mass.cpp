#include "solid-server/assembly/consistent_mass.hpp"

#include "solid-server/element/deformation.hpp"

namespace couplet::solid {

ConsistentMass::ConsistentMass(const SolidMesh& mesh, const std::vector<double>& density) {
  std::vector<Eigen::Triplet<double, Index>> entries;
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    const ElementBlock& block = mesh.block[b];
    const auto points = element_quadrature(block.shape, n_mass_points(block.shape));
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      const ElementVectors position = at_element(mesh.node_position, nodes);
      Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(position.rows(), position.rows());
      for (const QuadraturePoint& point : points) {
        const auto shape = shape_values(block.shape, point.xi);
        mass += density[b] * reference_point(block.shape, position, point).volume * shape * shape.transpose();
      }
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t c = 0; c < nodes.size(); ++c)
          entries.emplace_back(nodes[a], nodes[c], mass(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(c)));
    }
  }
  matrix_.resize(mesh.n_nodes(), mesh.n_nodes());
  matrix_.setFromTriplets(entries.begin(), entries.end());
}

Eigen::VectorXd ConsistentMass::row_sums() const {
  return matrix_ * Eigen::VectorXd::Ones(matrix_.cols());
}

double ConsistentMass::kinetic_energy(const NodeVectors& velocity) const {
  return times(velocity).cwiseProduct(velocity).sum() / 2;
}

std::size_t ConsistentMass::memory_bytes() const {
  return static_cast<std::size_t>(matrix_.nonZeros()) * (sizeof(double) + sizeof(Index));
}

}  // namespace couplet::solid
