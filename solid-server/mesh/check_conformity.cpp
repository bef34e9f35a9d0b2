#include "solid-server/mesh/check_conformity.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

namespace couplet::solid {

namespace {

/// An edge by its corners, rising, the node between them (-1: none), and an element that has it.
struct Edge {
  std::array<Index, 2> corner;
  Index midside, element;
};

std::vector<Edge> all_edges(const SolidMesh& mesh) {
  std::vector<Edge> edges;
  for (const ElementBlock& block : mesh.block) {
    const ElementTopology& t = topology(block.shape);
    const bool is_quadratic = t.n_nodes > t.n_corners;
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      for (std::size_t e = 0; e < t.edge.size() && t.edge[e][0] >= 0; ++e) {
        const auto [low, high] =
            std::minmax(nodes[static_cast<std::size_t>(t.edge[e][0])], nodes[static_cast<std::size_t>(t.edge[e][1])]);
        const Index midside = is_quadratic ? nodes[static_cast<std::size_t>(t.n_corners) + e] : -1;
        edges.push_back({{low, high}, midside, block.first_element + element});
      }
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.corner, a.midside, a.element) < std::tie(b.corner, b.midside, b.element);
  });
  return edges;
}

/// Three corners of a face, rising, and its element.
struct Triangle {
  std::array<Index, 3> corner;
  Index element;
  bool is_whole;  // a face, not half of a quadrilateral
};

/// Triangular faces, and the four halves that a diagonal may cut off a quadrilateral.
std::vector<Triangle> all_triangles(const SolidMesh& mesh) {
  std::vector<Triangle> triangles;
  const auto add = [&](Index a, Index b, Index c, Index element, bool is_whole) {
    Triangle triangle{{a, b, c}, element, is_whole};
    std::sort(triangle.corner.begin(), triangle.corner.end());
    triangles.push_back(triangle);
  };
  for (const ElementBlock& block : mesh.block) {
    const ElementTopology& t = topology(block.shape);
    for (Index element = 0; element < block.n_elements(); ++element)
      for (std::size_t side = 0; side < static_cast<std::size_t>(t.n_faces); ++side) {
        std::array<Index, 4> c{};
        for (std::size_t k = 0; k < static_cast<std::size_t>(t.n_face_corners); ++k)
          c[k] = block.nodes_of(element)[static_cast<std::size_t>(t.face_node[side][k])];
        const Index number = block.first_element + element;
        if (t.n_face_corners == 3) add(c[0], c[1], c[2], number, true);
        for (std::size_t k = 0; t.n_face_corners == 4 && k < 4; ++k)
          add(c[k], c[(k + 1) % 4], c[(k + 2) % 4], number, false);
      }
  }
  std::sort(triangles.begin(), triangles.end(), [](const Triangle& a, const Triangle& b) {
    return std::tie(a.corner, a.is_whole, a.element) < std::tie(b.corner, b.is_whole, b.element);
  });
  return triangles;
}

std::string sentence(const SolidMesh& mesh, Index one, Index other, int n_more, const char* what) {
  return mesh.describe_element(one) + " (" + topology(mesh.block_of(one).shape).name + ") and " +
         mesh.describe_element(other) + " (" + topology(mesh.block_of(other).shape).name + ") meet, but " + what +
         (n_more > 0 ? "; there are " + std::to_string(n_more) + " more such places" : "");
}

bool has_one_shape(const SolidMesh& mesh) {
  return std::all_of(mesh.block.begin(), mesh.block.end(),
                     [&](const ElementBlock& block) { return block.shape == mesh.block.front().shape; });
}

}  // namespace

std::optional<std::string> find_nonconforming(const SolidMesh& mesh) {
  if (mesh.block.empty() || has_one_shape(mesh)) return std::nullopt;
  const std::vector<Edge> edges = all_edges(mesh);
  const auto differ = [](const Edge& a, const Edge& b) { return a.corner == b.corner && a.midside != b.midside; };
  int n_bad = 0;
  std::size_t first = 0;
  for (std::size_t e = 1; e < edges.size(); ++e)
    if (differ(edges[e - 1], edges[e]) && n_bad++ == 0) first = e;
  if (n_bad > 0)
    return sentence(mesh, edges[first - 1].element, edges[first].element, n_bad - 1,
                    "have different nodes in the middle of a common edge; use elements of one order where they meet");

  const std::vector<Triangle> triangles = all_triangles(mesh);
  for (std::size_t n = 1; n < triangles.size(); ++n)
    if (triangles[n - 1].corner == triangles[n].corner && triangles[n - 1].is_whole != triangles[n].is_whole &&
        n_bad++ == 0)
      first = n;
  if (n_bad > 0)
    return sentence(mesh, triangles[first - 1].element, triangles[first].element, n_bad - 1,
                    "one has a triangle where the other has a quadrilateral; separate hexahedra from tetrahedra, and "
                    "join the parts by contact");
  return std::nullopt;
}

}  // namespace couplet::solid
