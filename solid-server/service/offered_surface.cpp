#include "solid-server/service/offered_surface.hpp"

#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

/// The largest extent of an element that has the node.
double size_of_elements_at(const SolidMesh& mesh, Index node) {
  double largest = 0;
  for (const ElementBlock& block : mesh.block)
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) continue;
      for (const Index other : nodes)
        largest = std::max(largest, (mesh.node_position.row(other) - mesh.node_position.row(node)).norm());
    }
  return largest;
}

}  // namespace

OfferedSurface offer_wetted(const WettedSurface& wetted) {
  return {wetted.surface, wetted.solid_node};
}

OfferedSurface offer_probed(const SolidMesh& mesh, const v1::Output& output) {
  OfferedSurface offered;
  std::vector<Index>& nodes = offered.solid_node;
  for (const auto& [name, node] : mesh.marker) nodes.push_back(node);
  for (int p = 0; p < output.probe_size(); ++p) {
    if (!output.probe(p).at().has_position()) continue;
    const v1::Vector& given = output.probe(p).at().position();
    const Eigen::Vector3d position(given.x(), given.y(), given.z());
    Eigen::Index nearest = 0;
    const double distance =
        std::sqrt((mesh.node_position.rowwise() - position.transpose()).rowwise().squaredNorm().minCoeff(&nearest));
    if (const double size = size_of_elements_at(mesh, static_cast<Index>(nearest)); !(distance <= size))
      throw report::SceneError("output.probe[" + std::to_string(p) + "].at.position",
                               place_text(position) + " is not in the solid: its nearest node, at " +
                                   place_text(mesh.node_position.row(nearest)) + ", is " + report::text(distance) +
                                   " m away, and elements there measure " + report::text(size) + " m",
                               "give a point of the body at rest, in metres");
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
