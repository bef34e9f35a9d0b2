#pragma once
// A body in its reference position: nodes, 20-node hexahedra, named surfaces, named nodes.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "solid-server/mesh/hex20_topology.hpp"

namespace couplet::solid {

using Index = std::int32_t;

/// One row a node: x, y, z.
using NodePositions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A face of an element.
struct ElementFace {
  Index element = 0;
  int side = 0;  // hex20::Side
};

using FaceNodes = std::array<Index, hex20::n_face_nodes>;

struct SolidMesh {
  NodePositions node_position;                                  // (n_nodes, 3) [m]
  std::vector<std::array<Index, hex20::n_nodes>> element_node;  // order of hex20_topology.hpp
  Index n_elements_per_layer =
      0;  // layers of so many elements follow each other and are likely copies of the first; 0: none
  std::map<std::string, std::vector<ElementFace>> surface;  // named parts of the boundary
  std::map<std::string, Index> marker;                      // named nodes

  Index n_nodes() const { return static_cast<Index>(node_position.rows()); }
  Index n_elements() const { return static_cast<Index>(element_node.size()); }

  /// The nodes of a face, with the right-hand normal out of the body.
  FaceNodes nodes_of(const ElementFace& face) const;

  /// A surface by name; throws SceneError naming `where` and the surfaces that there are.
  const std::vector<ElementFace>& find_surface(const std::string& name, const std::string& where) const;
};

/// The nodes of a set of faces, rising, each once.
std::vector<Index> nodes_of_faces(const SolidMesh& mesh, const std::vector<ElementFace>& faces);

}  // namespace couplet::solid
