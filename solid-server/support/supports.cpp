#include "solid-server/support/supports.hpp"

#include <algorithm>

namespace couplet::solid {

std::vector<SupportComponents> support_components(const SolidMesh& mesh, const Supports& supports) {
  std::vector<SupportComponents> found;
  Eigen::Array<bool, Eigen::Dynamic, 3> is_held =
      Eigen::Array<bool, Eigen::Dynamic, 3>::Constant(mesh.n_nodes(), 3, false);
  const auto add = [&](const std::string& name, const std::string& where, int first_axis, int last_axis) {
    auto support = std::find_if(found.begin(), found.end(), [&](const auto& s) { return s.name == name; });
    if (support == found.end()) support = found.insert(found.end(), {name, {}});
    for (const Index node : mesh.find_nodes(name, where))
      for (int axis = first_axis; axis <= last_axis; ++axis)
        if (!is_held(node, axis)) {
          is_held(node, axis) = true;
          support->components.push_back({node, axis});
        }
  };
  const auto entry = [](const std::string& list, std::size_t n) { return list + "[" + std::to_string(n) + "]"; };
  for (std::size_t s = 0; s < supports.prescribed.size(); ++s)
    add(supports.prescribed[s].nodes, entry("solid.prescribed_motion", s) + ".nodes", supports.prescribed[s].axis,
        supports.prescribed[s].axis);
  for (std::size_t s = 0; s < supports.fixed.size(); ++s) add(supports.fixed[s], "fixed", 0, 2);
  for (std::size_t s = 0; s < supports.symmetry.size(); ++s)
    add(supports.symmetry[s].surface, "symmetry", supports.symmetry[s].axis, supports.symmetry[s].axis);
  return found;
}

NodeVectors inverse_mass(const SolidMesh& mesh, const Eigen::VectorXd& mass, const Supports& supports) {
  NodeVectors inverse(mesh.n_nodes(), 4);
  inverse.leftCols<3>() = mass.cwiseInverse().replicate<1, 3>();
  inverse.col(3).setZero();
  for (const SupportComponents& support : support_components(mesh, supports))
    for (const auto& [node, axis] : support.components) inverse(node, axis) = 0;
  return inverse;
}

}  // namespace couplet::solid
