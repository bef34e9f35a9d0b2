#include "solid-server/mesh/element_shape.hpp"

#include "solid-server/mesh/hex20_topology.hpp"

namespace couplet::solid {

namespace {

constexpr std::array<std::array<int, 2>, 12> hexahedron_edge = {
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

/// Faces of the 20-node hexahedron by their first `n_kept` nodes.
ElementTopology hexahedron(const char* name, int n_nodes, FaceShape face_shape) {
  ElementTopology t{name, n_nodes, 8, hex20::n_faces, face_shape, n_nodes_of(face_shape), 4, {}, {}, hexahedron_edge};
  for (std::size_t f = 0; f < hex20::n_faces; ++f)
    for (std::size_t a = 0; a < max_face_nodes; ++a)
      t.face_node[f][a] = static_cast<int>(a) < t.n_face_nodes ? hex20::face_node[f][a] : -1;
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_nodes); ++a)
    for (std::size_t k = 0; k < 3; ++k) t.coordinate[a][k] = hex20::node_coordinate[a][k];
  return t;
}

/// Corners at the origin and at the ends of the unit vectors; midside nodes of edges 0-1, 1-2, 2-0, 0-3, 1-3, 2-3.
ElementTopology tetrahedron() {
  ElementTopology t{"tetrahedron10", 10, 4, 4, FaceShape::triangle6, 6, 3, {}, {}, {}};
  t.face_node = {{{0, 2, 1, 6, 5, 4, -1, -1},
                  {0, 1, 3, 4, 8, 7, -1, -1},
                  {1, 2, 3, 5, 9, 8, -1, -1},
                  {2, 0, 3, 6, 7, 9, -1, -1},
                  {-1, -1, -1, -1, -1, -1, -1, -1},
                  {-1, -1, -1, -1, -1, -1, -1, -1}}};
  t.coordinate = {{{0, 0, 0},
                   {1, 0, 0},
                   {0, 1, 0},
                   {0, 0, 1},
                   {.5, 0, 0},
                   {.5, .5, 0},
                   {0, .5, 0},
                   {0, 0, .5},
                   {.5, 0, .5},
                   {0, .5, .5}}};
  t.edge.fill({-1, -1});
  constexpr std::array<std::array<int, 2>, 6> edge = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  for (std::size_t e = 0; e < edge.size(); ++e) t.edge[e] = edge[e];
  return t;
}

}  // namespace

const ElementTopology& topology(ElementShape shape) {
  static const std::array<ElementTopology, n_element_shapes> shapes = {
      hexahedron("hexahedron20", 20, FaceShape::quadrilateral8),
      hexahedron("hexahedron8", 8, FaceShape::quadrilateral4), tetrahedron()};
  return shapes[static_cast<std::size_t>(shape)];
}

}  // namespace couplet::solid
