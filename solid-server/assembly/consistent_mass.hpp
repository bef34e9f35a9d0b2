#pragma once
// The consistent mass of all nodes, held ones included.

#include <Eigen/SparseCore>
#include <vector>

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// M_ab = integral of rho N_a N_b over the body at rest, the same for every component. Unlike the tangent it knows the
/// held nodes too, whose prescribed accelerations push their neighbours, and whose supports carry their inertia.
class ConsistentMass {
 public:
  /// `density` of each block at rest [kg/m^3].
  ConsistentMass(const SolidMesh& mesh, const std::vector<double>& density);

  NodeVectors times(const NodeVectors& vector) const { return matrix_ * vector; }
  Eigen::VectorXd row_sums() const;                        // (n_nodes) [kg]: what gravity acts on
  double kinetic_energy(const NodeVectors& velocity) const;  // v . M v / 2 [J]
  std::size_t memory_bytes() const;

 private:
  Eigen::SparseMatrix<double, Eigen::RowMajor, Index> matrix_;  // (n_nodes, n_nodes) [kg]
};

}  // namespace couplet::solid
