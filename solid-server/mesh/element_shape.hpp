#pragma once
// The kinds of elements that there are: where their nodes stand and which of them make their faces.

#include <array>
#include <cstddef>
#include <span>

namespace couplet::solid {

/// Node orders of VTK: corners first (bottom, then top), then midside nodes edge by edge.
enum class ElementShape { hexahedron20, hexahedron8, tetrahedron10 };
constexpr int n_element_shapes = 3;

/// Corners in the order of the right-hand normal out of the element, then the midside nodes between corners 0-1, 1-2,
/// and so on.
enum class FaceShape { quadrilateral8, quadrilateral4, triangle6 };

constexpr int max_element_nodes = 20;
constexpr int max_face_nodes = 8;

struct ElementTopology {
  const char* name;  // as users know it
  int n_nodes, n_corners, n_faces;
  FaceShape face_shape;  // of every face
  int n_face_nodes, n_face_corners;
  std::array<std::array<int, max_face_nodes>, 6> face_node;         // local nodes of each face; -1 where there is none
  std::array<std::array<double, 3>, max_element_nodes> coordinate;  // natural coordinates of the nodes
  std::array<std::array<int, 2>, 12> edge;  // corners of each edge; {-1, -1} where there is none
};

const ElementTopology& topology(ElementShape shape);

/// Nodes of a face of that shape: 8, 4 or 6.
constexpr int n_nodes_of(FaceShape shape) {
  return shape == FaceShape::quadrilateral8 ? 8 : shape == FaceShape::quadrilateral4 ? 4 : 6;
}

}  // namespace couplet::solid
