#include "solid-server/load/surface_rim.hpp"

#include <algorithm>

namespace couplet::solid {

std::vector<Index> nodes_of_rim(const std::vector<FaceNodes>& faces) {
  // Corners of a face come first, then the node between corners k and k + 1, if there is one.
  struct Edge {
    int n_faces = 0;
    Index middle = -1;
  };
  std::map<std::pair<Index, Index>, Edge> edges;  // by its ends, the smaller one first
  for (const FaceNodes& face : faces) {
    const std::size_t n_corners = face.shape() == FaceShape::triangle6 ? 3 : 4;
    for (std::size_t k = 0; k < n_corners; ++k) {
      Edge& edge = edges[std::minmax(face[k], face[(k + 1) % n_corners])];
      ++edge.n_faces;
      if (face.size() > n_corners) edge.middle = face[n_corners + k];
    }
  }
  std::vector<Index> rim;
  for (const auto& [ends, edge] : edges) {
    if (edge.n_faces > 1) continue;
    rim.insert(rim.end(), {ends.first, ends.second});
    if (edge.middle >= 0) rim.push_back(edge.middle);
  }
  std::sort(rim.begin(), rim.end());
  rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
  return rim;
}

}  // namespace couplet::solid
