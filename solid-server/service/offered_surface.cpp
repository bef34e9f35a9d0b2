#include "solid-server/service/offered_surface.hpp"

#include <algorithm>

namespace couplet::solid {

OfferedSurface offer_wetted(const WettedSurface& wetted) {
  return {wetted.surface, wetted.solid_node};
}

OfferedSurface offer_probed(const SolidMesh& mesh, const v1::Output& output) {
  OfferedSurface offered;
  std::vector<Index>& nodes = offered.solid_node;
  for (const auto& [name, node] : mesh.marker) nodes.push_back(node);
  for (const v1::Probe& probe : output.probe()) {
    if (!probe.at().has_position()) continue;
    const v1::Vector& position = probe.at().position();
    Eigen::Index nearest = 0;
    (mesh.node_position.rowwise() - Eigen::RowVector3d(position.x(), position.y(), position.z()))
        .rowwise()
        .squaredNorm()
        .minCoeff(&nearest);
    nodes.push_back(static_cast<Index>(nearest));
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  offered.surface.node_position.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t n = 0; n < nodes.size(); ++n)
    offered.surface.node_position.row(static_cast<Eigen::Index>(n)) = mesh.node_position.row(nodes[n]);
  for (const auto& [name, node] : mesh.marker)
    offered.surface.marker[name] = std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin();
  return offered;
}

}  // namespace couplet::solid
