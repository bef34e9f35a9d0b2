#pragma once
// Bodies in their reference position: nodes, elements in blocks of one kind, named surfaces and nodes.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "solid-server/mesh/element_shape.hpp"

namespace couplet::solid {

using Index = std::int32_t;

/// One row a node: x, y, z.
using NodePositions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A face of an element.
struct ElementFace {
  Index element = 0;  // counted through all blocks
  int side = 0;       // place in the topology's faces; hex20::Side for hexahedra
};

/// The nodes of a face: 8, 4 or 6 of them, with the right-hand normal out of the body.
class FaceNodes {
 public:
  FaceNodes() = default;
  explicit FaceNodes(FaceShape shape) : shape_(shape) { node_.fill(-1); }

  FaceShape shape() const { return shape_; }
  std::size_t size() const { return static_cast<std::size_t>(n_nodes_of(shape_)); }
  Index& operator[](std::size_t a) { return node_[a]; }
  Index operator[](std::size_t a) const { return node_[a]; }
  const Index* begin() const { return node_.data(); }
  const Index* end() const { return node_.data() + size(); }

 private:
  FaceShape shape_ = FaceShape::quadrilateral8;
  std::array<Index, max_face_nodes> node_{};
};

/// The first two of three perpendicular unit vectors that belong to an element at rest: along the fibres (in leaflets:
/// circumferential) and across them in the plane of the tissue.
using MaterialAxes = std::array<Eigen::Vector3d, 2>;

/// Elements of one shape in one region.
struct ElementBlock {
  ElementShape shape = ElementShape::hexahedron20;
  std::string region;               // name of the material region; empty: the mesh names none
  int body = 0;                     // number of its body, in the order in which they were joined
  std::vector<Index> node;          // (n_elements, nodes of the shape)
  Index first_element = 0;          // its number in the count through all blocks
  Index n_elements_per_layer = 0;   // layers of so many elements follow each other and are likely copies of the first;
                                    // 0: none
  std::vector<MaterialAxes> axes;   // (n_elements) or empty
  std::vector<std::int64_t> label;  // (n_elements) the element's number in the mesh file; empty: no file
  std::vector<int> line;            // (n_elements) where it stands there, from 1
  std::string file;                 // it was read from; empty: parametric

  Index n_elements() const { return static_cast<Index>(node.size()) / topology(shape).n_nodes; }
  std::span<const Index> nodes_of(Index element_of_block) const {
    const auto n = static_cast<std::size_t>(topology(shape).n_nodes);
    return {&node[static_cast<std::size_t>(element_of_block) * n], n};
  }
};

struct SolidMesh {
  NodePositions node_position;                              // (n_nodes, 3) [m]
  std::vector<ElementBlock> block;                          // elements are numbered through all blocks
  std::map<std::string, std::vector<ElementFace>> surface;  // named parts of the boundary
  std::map<std::string, std::vector<Index>> node_set;       // named sets of nodes, rising
  std::map<std::string, Index> marker;                      // named nodes

  Index n_nodes() const { return static_cast<Index>(node_position.rows()); }
  Index n_elements() const { return block.empty() ? 0 : block.back().first_element + block.back().n_elements(); }

  const ElementBlock& block_of(Index element) const;
  std::span<const Index> nodes_of(Index element) const;

  /// The nodes of a face, with the right-hand normal out of the body.
  FaceNodes nodes_of(const ElementFace& face) const;

  /// A surface by name; throws SceneError naming `where` and the surfaces that there are.
  const std::vector<ElementFace>& find_surface(const std::string& name, const std::string& where) const;

  /// The nodes of a surface, a node set or a marker of that name, rising; throws SceneError likewise, and where several
  /// of them have the name but other nodes.
  std::vector<Index> find_nodes(const std::string& name, const std::string& where) const;

  /// For messages: "element 12 at (x, y, z) m", with label, file and line where there are some.
  std::string describe_element(Index element) const;
};

/// "(x, y, z) m", for messages.
std::string place_text(const Eigen::Vector3d& position);

/// The nodes of a set of faces, rising, each once.
std::vector<Index> nodes_of_faces(const SolidMesh& mesh, const std::vector<ElementFace>& faces);

/// Several bodies as one mesh. With more than one, their names become "body/name" for surfaces, node sets, markers and
/// regions.
SolidMesh join_bodies(std::vector<SolidMesh> bodies, const std::vector<std::string>& names);

}  // namespace couplet::solid
