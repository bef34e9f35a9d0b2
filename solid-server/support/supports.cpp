#include "solid-server/support/supports.hpp"

namespace couplet::solid {

NodeVectors inverse_mass(const SolidMesh& mesh, const Eigen::VectorXd& mass, const Supports& supports) {
  NodeVectors inverse(mesh.n_nodes(), 4);
  inverse.leftCols<3>() = mass.cwiseInverse().replicate<1, 3>();
  inverse.col(3).setZero();
  for (std::size_t s = 0; s < supports.fixed.size(); ++s) {
    const std::string where = "solid.body[0].fixed[" + std::to_string(s) + "]";
    for (const Index node : mesh.find_nodes(supports.fixed[s], where)) inverse.row(node).setZero();
  }
  for (std::size_t s = 0; s < supports.symmetry.size(); ++s) {
    const auto& [name, axis] = supports.symmetry[s];
    const std::string where = "solid.body[0].symmetry[" + std::to_string(s) + "].surface";
    for (const Index node : mesh.find_nodes(name, where)) inverse(node, axis) = 0;
  }
  return inverse;
}

}  // namespace couplet::solid
