#include "solid-server/output/region_nodes.hpp"

#include <map>
#include <numeric>

namespace couplet::solid {

std::vector<int> region_numbers(const SolidMesh& mesh) {
  std::map<std::pair<int, std::string>, int> known;
  std::vector<int> numbers;
  for (const ElementBlock& block : mesh.block)
    numbers.push_back(known.try_emplace({block.body, block.region}, static_cast<int>(known.size())).first->second);
  return numbers;
}

RegionNodes shared_nodes(const SolidMesh& mesh) {
  RegionNodes nodes;
  nodes.origin.resize(static_cast<std::size_t>(mesh.n_nodes()));
  std::iota(nodes.origin.begin(), nodes.origin.end(), 0);
  for (const ElementBlock& block : mesh.block) nodes.block.push_back(block.node);
  return nodes;
}

RegionNodes nodes_by_region(const SolidMesh& mesh) {
  RegionNodes nodes = shared_nodes(mesh);
  const std::vector<int> region = region_numbers(mesh);
  std::vector<int> owner(nodes.origin.size(), -1);
  std::map<std::pair<Index, int>, Index> copies;  // of a node, for a region
  for (std::size_t b = 0; b < nodes.block.size(); ++b)
    for (Index& node : nodes.block[b]) {
      int& first = owner[static_cast<std::size_t>(node)];
      if (first < 0) first = region[b];
      if (first == region[b]) continue;
      const auto [copy, is_new] = copies.try_emplace({node, region[b]}, nodes.n_nodes());
      if (is_new) nodes.origin.push_back(node);
      node = copy->second;
    }
  return nodes;
}

}  // namespace couplet::solid
