#include "solid-server/mesh/face_search.hpp"

#include <algorithm>

namespace couplet::solid {

FaceSearch::Key FaceSearch::key_of(std::span<const Index> corners) {
  Key key = {-1, -1, -1, -1};
  for (std::size_t n = 0; n < std::min(corners.size(), key.size());
       ++n) {  // sorted by insertion: they are four at most
    std::size_t place = n;
    for (; place > 0 && key[place - 1] > corners[n]; --place) key[place] = key[place - 1];
    key[place] = corners[n];
  }
  return key;
}

FaceSearch::Key FaceSearch::key_of(const SolidMesh& mesh, const ElementFace& face) {
  const ElementTopology& shape = topology(mesh.block_of(face.element).shape);
  const FaceNodes nodes = mesh.nodes_of(face);
  return key_of({nodes.begin(), static_cast<std::size_t>(shape.n_face_corners)});
}

std::size_t FaceSearch::Hash::operator()(const Key& key) const {
  std::uint64_t hash = 0;
  for (const Index node : key)
    hash = (hash ^ static_cast<std::uint32_t>(node)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32;
  return hash;
}

void FaceSearch::sweep(const SolidMesh& mesh) {
  std::array<Index, 4> corners{};
  for (const ElementBlock& block : mesh.block) {
    const ElementTopology& shape = topology(block.shape);
    const auto n_corners = static_cast<std::size_t>(shape.n_face_corners);
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      for (int side = 0; side < shape.n_faces; ++side) {
        const auto& local = shape.face_node[static_cast<std::size_t>(side)];
        for (std::size_t c = 0; c < n_corners; ++c) corners[c] = nodes[static_cast<std::size_t>(local[c])];
        const auto found = found_.find(key_of(std::span(corners).first(n_corners)));
        if (found == found_.end()) continue;
        if (found->second.n_elements++ == 0) found->second.first = {block.first_element + element, side};
      }
    }
  }
}

}  // namespace couplet::solid
