#include "solid-server/support/supports.hpp"

namespace couplet::solid {

NodeVectors inverse_mass(const SolidMesh& mesh, const Eigen::VectorXd& mass, const Supports& supports) {
  NodeVectors inverse(mesh.n_nodes(), 4);
  inverse.leftCols<3>() = mass.cwiseInverse().replicate<1, 3>();
  inverse.col(3).setZero();
  for (std::size_t s = 0; s < supports.fixed.size(); ++s) {
    const auto& faces = mesh.find_surface(supports.fixed[s], "solid.body[0].fixed[" + std::to_string(s) + "]");
    for (const Index node : nodes_of_faces(mesh, faces)) inverse.row(node).setZero();
  }
  for (std::size_t s = 0; s < supports.symmetry.size(); ++s) {
    const auto& [name, axis] = supports.symmetry[s];
    const auto& faces = mesh.find_surface(name, "solid.body[0].symmetry[" + std::to_string(s) + "].surface");
    for (const Index node : nodes_of_faces(mesh, faces)) inverse(node, axis) = 0;
  }
  return inverse;
}

}  // namespace couplet::solid
