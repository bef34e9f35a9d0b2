#include "solid-server/mesh/parametric/merge_patches.hpp"

#include <algorithm>

#include "solid-server/mesh/coincident_nodes.hpp"

namespace couplet::solid {

namespace {

struct MergedNodes {
  NodePositions position;
  std::vector<Index> node;  // the merged node of every node of every patch, one patch after the other
};

MergedNodes merge_nodes(const std::vector<SolidMesh>& patches) {
  Index n_nodes = 0;
  for (const SolidMesh& patch : patches) n_nodes += patch.n_nodes();
  NodePositions all(n_nodes, 3);
  Index first = 0;
  for (const SolidMesh& patch : patches) {
    all.middleRows(first, patch.n_nodes()) = patch.node_position;
    first += patch.n_nodes();
  }
  const std::vector<Index> same = find_coincident_nodes(all, coincidence_tolerance(all));
  MergedNodes merged;
  merged.node.resize(same.size());
  Index n_kept = 0;
  for (std::size_t node = 0; node < same.size(); ++node) {
    const auto kept = static_cast<std::size_t>(same[node]);  // not above node
    merged.node[node] = kept == node ? n_kept++ : merged.node[kept];
  }
  merged.position.resize(n_kept, 3);
  for (std::size_t node = 0; node < same.size(); ++node)
    if (static_cast<std::size_t>(same[node]) == node)
      merged.position.row(merged.node[node]) = all.row(static_cast<Eigen::Index>(node));
  return merged;
}

/// The elements of `from` behind those of `to`, with the nodes as they are called in the merged mesh.
void append_elements(const ElementBlock& from, Index first_node, const std::vector<Index>& merged, ElementBlock& to) {
  for (const Index node : from.node) to.node.push_back(merged[static_cast<std::size_t>(first_node + node)]);
  to.axes.insert(to.axes.end(), from.axes.begin(), from.axes.end());
}

}  // namespace

SolidMesh merge_patches(const std::vector<SolidMesh>& patches) {
  MergedNodes nodes = merge_nodes(patches);
  SolidMesh merged;
  merged.node_position = std::move(nodes.position);

  struct Source {
    std::size_t patch;
    Index first_in_patch, n_elements;  // elements of the patch
    std::size_t block;                 // where they went
    Index first_in_block;
  };
  std::vector<Source> sources;
  Index first_node = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    for (const ElementBlock& from : patches[p].block) {
      auto to = std::find_if(merged.block.begin(), merged.block.end(), [&](const ElementBlock& block) {
        return block.region == from.region && block.shape == from.shape;
      });
      if (to == merged.block.end()) {
        to = merged.block.insert(to, ElementBlock{});
        to->shape = from.shape;
        to->region = from.region;
        to->n_elements_per_layer = from.n_elements_per_layer;
      } else {
        to->n_elements_per_layer = 0;
      }
      sources.push_back({p, from.first_element, from.n_elements(), static_cast<std::size_t>(to - merged.block.begin()),
                         to->n_elements()});
      append_elements(from, first_node, nodes.node, *to);
    }
    first_node += patches[p].n_nodes();
  }
  for (std::size_t b = 1; b < merged.block.size(); ++b)
    merged.block[b].first_element = merged.block[b - 1].first_element + merged.block[b - 1].n_elements();

  const auto merged_face = [&](std::size_t patch, const ElementFace& face) -> ElementFace {
    const auto source = std::find_if(sources.begin(), sources.end(), [&](const Source& s) {
      return s.patch == patch && face.element >= s.first_in_patch && face.element < s.first_in_patch + s.n_elements;
    });
    return {merged.block[source->block].first_element + source->first_in_block + face.element - source->first_in_patch,
            face.side};
  };
  first_node = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto merged_node = [&](Index node) { return nodes.node[static_cast<std::size_t>(first_node + node)]; };
    for (const auto& [name, faces] : patches[p].surface)
      for (const ElementFace& face : faces) merged.surface[name].push_back(merged_face(p, face));
    for (const auto& [name, set] : patches[p].node_set)
      for (const Index node : set) merged.node_set[name].push_back(merged_node(node));
    for (const auto& [name, node] : patches[p].marker) merged.marker[name] = merged_node(node);
    first_node += patches[p].n_nodes();
  }
  for (auto& [name, set] : merged.node_set) {
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }
  return merged;
}

}  // namespace couplet::solid
