#pragma once
// Small mesh files for tests: two cubes with 20 nodes each side by side along x, of the regions "soft" and "stiff";
// surfaces "left" and "right", node set "edge" (the edge x = 0, y = 0), marker "corner" (the origin).

#include <array>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "solid-server/mesh/parametric/structured_block.hpp"

namespace couplet::solid {

/// Replaces the only place where `from` stands.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos || text.find(from, place + 1) != std::string::npos)
    throw std::runtime_error("\"" + from + "\" must stand in the text once");
  return text.replace(place, from.size(), to);
}

inline std::string with_crlf(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return out;
}

class TwoCubes {
 public:
  explicit TwoCubes(double edge = 1) {
    const StructuredBlock block(2, 1, 1);
    mesh =
        block.mesh([&](const HalfIndex& p) -> Eigen::Vector3d { return Eigen::Vector3d(p.i, p.j, p.k) * (edge / 2); });
    for (int k = 0; k <= 2; ++k) edge_node.push_back(block.node_at({0, 0, k}) + 1);
  }

  /// Corners between which Gmsh's midside nodes stand, by its manual.
  static constexpr std::array<std::array<int, 2>, 12> gmsh_edge = {
      {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};

  std::string gmsh_4() const {
    std::ostringstream out;
    out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
        << physical_names() << "$Entities\n1 1 2 2\n1 0 0 0 1 1 \n"
        << "1 0 0 0 0 0 1 1 2 2 1 -1 \n1 0 0 0 0 1 1 1 3 0 \n2 2 0 0 2 1 1 1 4 0 \n"
        << "1 0 0 0 1 1 1 1 5 0 \n2 1 0 0 2 1 1 1 6 0 \n$EndEntities\n";
    out << "$Nodes\n1 " << mesh.n_nodes() << " 1 " << mesh.n_nodes() << "\n3 1 0 " << mesh.n_nodes() << "\n";
    for (Index n = 0; n < mesh.n_nodes(); ++n) out << n + 1 << "\n";
    for (Index n = 0; n < mesh.n_nodes(); ++n) out << place(n, " ") << "\n";
    out << "$EndNodes\n$Elements\n6 6 1 6\n0 1 15 1\n1 " << edge_node[0] << " \n1 1 8 1\n2" << edge_line()
        << "\n2 1 16 1\n3" << face(0, 0) << "\n2 2 16 1\n4" << face(1, 1) << "\n3 1 17 1\n5" << gmsh_nodes(0)
        << "\n3 2 17 1\n6" << gmsh_nodes(1) << "\n$EndElements\n";
    return out.str();
  }

  std::string gmsh_2() const {
    std::ostringstream out;
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" << physical_names() << "$Nodes\n" << mesh.n_nodes() << "\n";
    for (Index n = 0; n < mesh.n_nodes(); ++n) out << n + 1 << " " << place(n, " ") << "\n";
    out << "$EndNodes\n$Elements\n6\n1 15 2 1 1 " << edge_node[0] << "\n2 8 2 2 1" << edge_line() << "\n3 16 2 3 1"
        << face(0, 0) << "\n4 16 2 4 2" << face(1, 1) << "\n5 17 2 5 1" << gmsh_nodes(0) << "\n6 17 2 6 2"
        << gmsh_nodes(1) << "\n$EndElements\n";
    return out.str();
  }

  std::string abaqus() const {
    std::ostringstream out;
    out << "** two cubes\n*Heading\n a title\n*Node\n";
    for (Index n = 0; n < mesh.n_nodes(); ++n) out << n + 1 << ", " << place(n, ", ") << "\n";
    for (const Index e : {0, 1}) {
      out << "*Element, type=C3D20, elset=" << (e == 0 ? "soft" : "stiff") << "\n" << e + 5 << ",";
      for (std::size_t a = 0; a < 20; ++a) out << mesh.nodes_of(e)[a] + 1 << (a == 19 ? "\n" : a == 14 ? ",\n" : ", ");
    }
    out << "*NSET, NSET=edge\n"
        << edge_node[0] << ", " << edge_node[1] << ",\n"
        << edge_node[2] << "\n*NSET,NSET=corner\n"
        << edge_node[0] << ",\n*SURFACE, NAME=left\n5, S6\n*Surface, name=right, type=element\nSTIFF, s4\n"
        << "*MATERIAL, NAME=rubber\n*ELASTIC\n1., .3\n*STEP\n*STATIC\n*END STEP\n";
    return out.str();
  }

  SolidMesh mesh;
  std::vector<Index> edge_node;  // labels: corner, midside, corner

 private:
  static std::string physical_names() {
    return "$PhysicalNames\n6\n0 1 \"corner\"\n1 2 \"edge\"\n2 3 \"left\"\n2 4 \"right\"\n3 5 \"soft\"\n3 6 \"stiff\"\n"
           "$EndPhysicalNames\n";
  }
  std::string place(Index node, const char* separator) const {
    std::ostringstream out;
    out.precision(17);
    const Eigen::RowVector3d p = mesh.node_position.row(node);
    out << p.x() << separator << p.y() << separator << p.z();
    return out.str();
  }
  std::string edge_line() const {
    return " " + std::to_string(edge_node[0]) + " " + std::to_string(edge_node[2]) + " " + std::to_string(edge_node[1]);
  }
  std::string face(Index element, int side) const {
    std::string out;
    for (const Index node : mesh.nodes_of(ElementFace{element, side})) out += " " + std::to_string(node + 1);
    return out;
  }
  std::string gmsh_nodes(Index element) const {
    const auto nodes = mesh.nodes_of(element);
    const auto& edges = topology(ElementShape::hexahedron20).edge;
    std::string out;
    for (std::size_t c = 0; c < 8; ++c) out += " " + std::to_string(nodes[c] + 1);
    for (const auto& [a, b] : gmsh_edge)
      for (std::size_t e = 0; e < edges.size(); ++e)
        if ((edges[e][0] == a && edges[e][1] == b) || (edges[e][0] == b && edges[e][1] == a))
          out += " " + std::to_string(nodes[8 + e] + 1);
    return out;
  }
};

}  // namespace couplet::solid
