#include "solid-server/mesh/solid_mesh.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

template <class Map>
std::string names_in(const Map& map) {
  std::string names;
  for (const auto& entry : map) names += (names.empty() ? "" : ", ") + entry.first;
  return names;
}

}  // namespace

const ElementBlock& SolidMesh::block_of(Index element) const {
  const auto after = std::upper_bound(block.begin(), block.end(), element,
                                      [](Index e, const ElementBlock& b) { return e < b.first_element; });
  return *std::prev(after);
}

std::span<const Index> SolidMesh::nodes_of(Index element) const {
  const ElementBlock& elements = block_of(element);
  return elements.nodes_of(element - elements.first_element);
}

FaceNodes SolidMesh::nodes_of(const ElementFace& face) const {
  const ElementTopology& shape = topology(block_of(face.element).shape);
  const auto element = nodes_of(face.element);
  const auto& local = shape.face_node[static_cast<std::size_t>(face.side)];
  FaceNodes nodes(shape.face_shape);
  for (std::size_t a = 0; a < nodes.size(); ++a) nodes[a] = element[static_cast<std::size_t>(local[a])];
  return nodes;
}

const std::vector<ElementFace>& SolidMesh::find_surface(const std::string& name, const std::string& where) const {
  const auto found = surface.find(name);
  if (found != surface.end()) return found->second;
  throw report::SceneError(
      where, "the mesh has no surface \"" + name + "\"",
      surface.empty() ? "name the surfaces in the mesh file" : "choose one of: " + names_in(surface));
}

std::vector<Index> SolidMesh::find_nodes(const std::string& name, const std::string& where) const {
  std::vector<std::vector<Index>> found;  // a mesh file may give a surface and a node set the same name
  if (const auto faces = surface.find(name); faces != surface.end())
    found.push_back(nodes_of_faces(*this, faces->second));
  if (const auto nodes = node_set.find(name); nodes != node_set.end()) found.push_back(nodes->second);
  if (const auto node = marker.find(name); node != marker.end()) found.push_back({node->second});
  if (std::adjacent_find(found.begin(), found.end(), std::not_equal_to<>()) != found.end())
    throw report::SceneError(where,
                             "\"" + name + "\" is the name of a surface and of a node set of the mesh with other nodes",
                             "give one of them another name");
  if (!found.empty()) return found.front();
  std::string known = names_in(surface);
  for (const std::string& more : {names_in(node_set), names_in(marker)})
    if (!more.empty()) known += (known.empty() ? "" : ", ") + more;
  throw report::SceneError(where, "the mesh has no surface, node set or marker \"" + name + "\"",
                           known.empty() ? "name them in the mesh file" : "choose one of: " + known);
}

std::string SolidMesh::describe_element(Index element) const {
  const ElementBlock& elements = block_of(element);
  const auto within = static_cast<std::size_t>(element - elements.first_element);
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
  const auto nodes = nodes_of(element);
  for (const Index node : nodes) middle += node_position.row(node) / static_cast<double>(nodes.size());
  std::string text = "element " + std::to_string(elements.label.empty() ? element : elements.label[within]);
  if (!elements.line.empty()) text += " (" + elements.file + ", line " + std::to_string(elements.line[within]) + ")";
  return text + " at " + place_text(middle);
}

std::string place_text(const Eigen::Vector3d& position) {
  return "(" + report::text(position.x()) + ", " + report::text(position.y()) + ", " + report::text(position.z()) +
         ") m";
}

std::vector<Index> nodes_of_faces(const SolidMesh& mesh, const std::vector<ElementFace>& faces) {
  std::vector<Index> nodes;
  for (const ElementFace& face : faces) {
    const FaceNodes face_nodes = mesh.nodes_of(face);
    nodes.insert(nodes.end(), face_nodes.begin(), face_nodes.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

SolidMesh join_bodies(std::vector<SolidMesh> bodies, const std::vector<std::string>& names) {
  if (bodies.size() == 1) return std::move(bodies.front());
  SolidMesh joined;
  Index n_nodes = 0;
  for (const SolidMesh& body : bodies) n_nodes += body.n_nodes();
  joined.node_position.resize(n_nodes, 3);
  Index first_node = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    SolidMesh& body = bodies[b];
    const std::string prefix = names[b] + "/";
    const Index first_element = joined.n_elements();
    joined.node_position.middleRows(first_node, body.n_nodes()) = body.node_position;
    for (ElementBlock& block : body.block) {
      for (Index& node : block.node) node += first_node;
      block.first_element += first_element;
      block.region = block.region.empty() ? names[b] : prefix + block.region;
      block.body = static_cast<int>(b);
      joined.block.push_back(std::move(block));
    }
    for (auto& [name, faces] : body.surface) {
      for (ElementFace& face : faces) face.element += first_element;
      joined.surface[prefix + name] = std::move(faces);
    }
    for (auto& [name, nodes] : body.node_set) {
      for (Index& node : nodes) node += first_node;
      joined.node_set[prefix + name] = std::move(nodes);
    }
    for (const auto& [name, node] : body.marker) joined.marker[prefix + name] = node + first_node;
    first_node += body.n_nodes();
  }
  return joined;
}

}  // namespace couplet::solid
