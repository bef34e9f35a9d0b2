#include "solid-server/mesh/find_overlap.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/mesh/face_search.hpp"

namespace couplet::solid {

namespace {

/// An element between planes: a point x is behind side s where (x - middle_s) . normal_s < 0.
struct Polyhedron {
  Index element = 0;
  Eigen::AlignedBox3d box;
  std::array<Eigen::Vector3d, 6> middle, normal;
  std::array<bool, 6> is_outer{};  // no other element behind the side
  int n_sides = 0;
  double size = 0;  // cube root of the volume [m]
};

Polyhedron polyhedron_of(const SolidMesh& mesh, Index element) {
  const ElementTopology& t = topology(mesh.block_of(element).shape);
  const auto nodes = mesh.nodes_of(element);
  const auto corner = [&](int c) -> Eigen::Vector3d {
    return mesh.node_position.row(nodes[static_cast<std::size_t>(c)]);
  };
  Polyhedron out;
  out.element = element;
  out.n_sides = t.n_faces;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int c = 0; c < t.n_corners; ++c) {
    out.box.extend(corner(c));
    centre += corner(c) / t.n_corners;
  }
  double volume = 0;
  for (std::size_t s = 0; s < static_cast<std::size_t>(t.n_faces); ++s) {
    const auto at = [&](int c) { return corner(t.face_node[s][static_cast<std::size_t>(c)]); };
    const int n = t.n_face_corners;
    out.middle[s].setZero();
    for (int c = 0; c < n; ++c) out.middle[s] += at(c) / n;
    // Half the vector product of the diagonals, of a triangle's edges: the face's area vector.
    const Eigen::Vector3d area = (at(2) - at(0)).cross(n == 4 ? at(3) - at(1) : at(2) - at(1)) / 2;
    volume += (out.middle[s] - centre).dot(area) / 3;
    out.normal[s] = area.normalized();
  }
  out.size = std::cbrt(std::abs(volume));
  return out;
}

bool is_inside(const Polyhedron& element, const Eigen::Vector3d& x) {
  constexpr double tolerated_depth = 0.1, round_off = 1e-9;  // of the size
  for (std::size_t s = 0; s < static_cast<std::size_t>(element.n_sides); ++s) {
    const double height = (x - element.middle[s]).dot(element.normal[s]) / element.size;
    if (height > (element.is_outer[s] ? -tolerated_depth : round_off)) return false;
  }
  return true;
}

void find_outer_sides(const SolidMesh& mesh, std::vector<Polyhedron>& elements) {
  FaceSearch search;
  const auto for_each_side = [&](const auto& visit) {
    for (Polyhedron& element : elements)
      for (int side = 0; side < element.n_sides; ++side)
        visit(element, side, FaceSearch::key_of(mesh, {element.element, side}));
  };
  for_each_side([&](const Polyhedron&, int, const FaceSearch::Key& key) { search.want(key); });
  search.sweep(mesh);
  for_each_side([&](Polyhedron& element, int side, const FaceSearch::Key& key) {
    element.is_outer[static_cast<std::size_t>(side)] = search.find(key).n_elements == 1;
  });
}

}  // namespace

std::optional<Overlap> find_overlap(const SolidMesh& mesh, const std::vector<ElementFace>& faces,
                                    const std::vector<ElementFace>& others) {
  const MeshParts parts = find_parts(mesh);
  const auto part_of = [&](Index node) { return parts.part_of_node[static_cast<std::size_t>(node)]; };
  std::set<Index> other_parts;
  for (const ElementFace& face : others) other_parts.insert(part_of(mesh.nodes_of(face.element).front()));
  const std::vector<Index> nodes = nodes_of_faces(mesh, faces);
  Eigen::AlignedBox3d reached;
  for (const Index node : nodes) reached.extend(mesh.node_position.row(node).transpose());

  std::vector<Polyhedron> elements;
  double widest = 0;
  for (Index e = 0; e < mesh.n_elements(); ++e) {
    if (!other_parts.contains(part_of(mesh.nodes_of(e).front()))) continue;
    Polyhedron element = polyhedron_of(mesh, e);
    if (!element.box.intersects(reached)) continue;
    widest = std::max(widest, element.box.sizes().x());
    elements.push_back(std::move(element));
  }
  find_outer_sides(mesh, elements);
  const auto begins_before = [](const Polyhedron& element, double x) { return element.box.min().x() < x; };
  std::sort(elements.begin(), elements.end(),
            [](const Polyhedron& a, const Polyhedron& b) { return a.box.min().x() < b.box.min().x(); });
  for (const Index node : nodes) {
    const Eigen::Vector3d x = mesh.node_position.row(node);
    const auto first = std::lower_bound(elements.begin(), elements.end(), x.x() - widest, begins_before);
    for (auto element = first; element != elements.end() && element->box.min().x() <= x.x(); ++element)
      if (part_of(mesh.nodes_of(element->element).front()) != part_of(node) && element->box.contains(x) &&
          is_inside(*element, x))
        return Overlap{node, element->element};
  }
  return std::nullopt;
}

}  // namespace couplet::solid
