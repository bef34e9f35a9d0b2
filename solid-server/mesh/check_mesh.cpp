#include "solid-server/mesh/check_mesh.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_conformity.hpp"
#include "solid-server/mesh/coincident_nodes.hpp"
#include "solid-server/mesh/face_search.hpp"
#include "solid-server/mesh/node_order.hpp"

namespace couplet::solid {

namespace {

/// Lines of complaints, as many as a user can read.
class MeshComplaints {
 public:
  explicit MeshComplaints(std::string where) : where_(std::move(where)) {}

  bool is_full() const { return n_ >= n_shown; }
  void add(const std::string& sentence) {
    if (n_++ < n_shown) lines_ += (lines_.empty() ? "" : "\n") + where_ + ": " + sentence;
  }
  void count() { ++n_; }
  void throw_if_any() const {
    if (n_ == 0) return;
    throw report::SceneError(
        "", lines_ + (n_ > n_shown ? "\n" + where_ + ": and " + std::to_string(n_ - n_shown) + " more" : ""));
  }

 private:
  static constexpr Index n_shown = 10;
  std::string where_, lines_;
  Index n_ = 0;
};

std::string nodes_text(Index n, const char* one, const char* several) {
  return n == 1 ? std::string("a node ") + one : std::to_string(n) + " nodes " + several;
}

void check_nodes(const SolidMesh& mesh, MeshComplaints& complaints) {
  std::vector<bool> is_used(static_cast<std::size_t>(mesh.n_nodes()), false);
  for (const ElementBlock& block : mesh.block)
    for (const Index node : block.node) is_used[static_cast<std::size_t>(node)] = true;
  const auto n_unused = static_cast<Index>(std::count(is_used.begin(), is_used.end(), false));
  if (n_unused > 0) {
    const auto first = static_cast<Index>(std::find(is_used.begin(), is_used.end(), false) - is_used.begin());
    complaints.add(nodes_text(n_unused, "belongs", "belong") + " to no element, the first at " +
                   place_text(mesh.node_position.row(first)) + "; leave them out");
  }
  const std::vector<Index> same = find_coincident_nodes(mesh.node_position, coincidence_tolerance(mesh.node_position));
  Index n_doubled = 0, first = -1;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Index other = same[static_cast<std::size_t>(node)];
    if (other == node || !is_used[static_cast<std::size_t>(node)] || !is_used[static_cast<std::size_t>(other)])
      continue;
    if (n_doubled++ == 0) first = node;
  }
  if (n_doubled > 0)
    complaints.add(nodes_text(n_doubled, "stands", "stand") +
                   " at the place of another one without being connected, the first at " +
                   place_text(mesh.node_position.row(first)) +
                   "; merge such nodes, or leave a gap between parts that shall move apart");
}

void check_regions(const SolidMesh& mesh, MeshComplaints& complaints) {
  const ElementBlock* unnamed = nullptr;
  Index n_unnamed = 0;
  bool has_names = false;
  for (const ElementBlock& block : mesh.block) {
    has_names = has_names || !block.region.empty();
    if (!block.region.empty()) continue;
    n_unnamed += block.n_elements();
    if (unnamed == nullptr) unnamed = &block;
  }
  if (has_names && unnamed != nullptr)
    complaints.add(std::to_string(n_unnamed) + " elements belong to no region, the first is " +
                   mesh.describe_element(unnamed->first_element) + "; name a region for every element or for none");
}

void check_surfaces(const SolidMesh& mesh, MeshComplaints& complaints) {
  const auto has_face = [&](const ElementFace& face) {
    return face.element >= 0 && face.element < mesh.n_elements() && face.side >= 0 &&
           face.side < topology(mesh.block_of(face.element).shape).n_faces;
  };
  FaceSearch search;
  for (const auto& [name, faces] : mesh.surface)
    for (const ElementFace& face : faces)
      if (has_face(face)) search.want(FaceSearch::key_of(mesh, face));
  search.sweep(mesh);
  for (const auto& [name, faces] : mesh.surface) {
    Index n_nowhere = 0, n_inside = 0, n_twice = 0;
    Index first_inside = -1, first_twice = -1;
    std::set<FaceSearch::Key> seen;
    for (const ElementFace& face : faces) {
      if (!has_face(face)) {
        ++n_nowhere;
        continue;
      }
      const FaceSearch::Key key = FaceSearch::key_of(mesh, face);
      if (search.find(key).n_elements > 1 && n_inside++ == 0) first_inside = face.element;
      if (!seen.insert(key).second && n_twice++ == 0) first_twice = face.element;
    }
    const std::string surface = "surface \"" + name + "\": ";
    if (faces.empty()) complaints.add(surface + "has no faces");
    if (n_nowhere > 0) complaints.add(surface + std::to_string(n_nowhere) + " of its faces belong to no element");
    if (n_inside > 0)
      complaints.add(surface + std::to_string(n_inside) + " of its faces lie between two elements, the first at " +
                     mesh.describe_element(first_inside) + "; a surface must be on the outside");
    if (n_twice > 0)
      complaints.add(surface + std::to_string(n_twice) + " of its faces stand there twice, the first at " +
                     mesh.describe_element(first_twice));
  }
}

/// Elements with the same corners: Gmsh writes one for each physical volume in files of version 2.2.
void check_doubled_elements(const SolidMesh& mesh, MeshComplaints& complaints) {
  std::vector<std::pair<std::uint64_t, Index>> elements;  // a sum that does not depend on the order of the corners
  elements.reserve(static_cast<std::size_t>(mesh.n_elements()));
  for (const ElementBlock& block : mesh.block)
    for (Index element = 0; element < block.n_elements(); ++element) {
      std::uint64_t sum = 0;
      for (const Index node :
           block.nodes_of(element).first(static_cast<std::size_t>(topology(block.shape).n_corners))) {
        std::uint64_t mixed = (static_cast<std::uint64_t>(node) + 1) * 0x9e3779b97f4a7c15u;
        mixed = (mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u;
        sum += mixed ^ (mixed >> 32);
      }
      elements.emplace_back(sum, block.first_element + element);
    }
  std::sort(elements.begin(), elements.end());
  for (std::size_t n = 1; n < elements.size(); ++n)
    if (elements[n].first == elements[n - 1].first) {
      if (complaints.is_full()) {
        complaints.count();
        continue;
      }
      complaints.add(mesh.describe_element(elements[n].second) + ": has the same corners as " +
                     mesh.describe_element(elements[n - 1].second) + "; an element belongs to one region only");
    }
}

bool names_a_node_twice(std::span<const Index> nodes) {
  std::array<Index, max_element_nodes> sorted{};
  const auto end = std::copy(nodes.begin(), nodes.end(), sorted.begin());
  std::sort(sorted.begin(), end);
  return std::adjacent_find(sorted.begin(), end) != end;
}

bool is_good(const MidsidePlace& place) {
  return place.is_good();
}

/// What is wrong with an element that has a Jacobian not above 0 or a midside node far from the middle of its edge.
std::string shape_complaint(ElementShape shape, const Eigen::Matrix3Xd& position, const JacobianMeasure& measure) {
  if (would_be_good_in_another_order(shape, position, measure))
    return "its nodes are in the wrong order; write them in the order of the file's format";
  const JacobianRange jacobian = measure.of(position);
  if (jacobian.largest <= 0) return "is inverted: its Jacobian is nowhere above 0";
  const auto midsides = midside_places(shape, position);
  if (const auto bad = std::find_if_not(midsides.begin(), midsides.end(), is_good); bad != midsides.end()) {
    const auto& edge = topology(shape).edge[static_cast<std::size_t>(bad - midsides.begin())];
    return "its node between corners " + std::to_string(edge[0] + 1) + " and " + std::to_string(edge[1] + 1) +
           " stands at " + report::text(bad->along) + " of the edge, " + report::text(bad->from_middle) +
           " of its length from its middle; midside nodes must keep to the middle half";
  }
  return "is folded: its Jacobian goes from " + report::text(jacobian.smallest) + " to " +
         report::text(jacobian.largest) + " m^3; it must be above 0 everywhere";
}

void check_elements(const SolidMesh& mesh, MeshComplaints& complaints) {
  for (const ElementBlock& block : mesh.block) {
    const JacobianMeasure measure(block.shape);
    Eigen::Matrix3Xd position(3, topology(block.shape).n_nodes);
    for (Index element = 0; element < block.n_elements(); ++element) {
      const auto nodes = block.nodes_of(element);
      for (std::size_t a = 0; a < nodes.size(); ++a)
        position.col(static_cast<Eigen::Index>(a)) = mesh.node_position.row(nodes[a]).transpose();
      const bool is_repeating = names_a_node_twice(nodes);
      const auto midsides = midside_places(block.shape, position);
      if (!is_repeating && measure.of(position).smallest > 0 && std::all_of(midsides.begin(), midsides.end(), is_good))
        continue;
      if (complaints.is_full()) {  // the sentence takes long to find
        complaints.count();
        continue;
      }
      complaints.add(mesh.describe_element(block.first_element + element) + ": " +
                     (is_repeating ? "names a node twice" : shape_complaint(block.shape, position, measure)));
    }
  }
}

}  // namespace

void check_mesh(const SolidMesh& mesh, const std::string& where) {
  if (mesh.n_elements() == 0) throw report::SceneError(where, "the mesh has no elements");
  for (const ElementBlock& block : mesh.block)
    for (std::size_t n = 0; n < block.node.size(); ++n)
      if (block.node[n] < 0 || block.node[n] >= mesh.n_nodes())
        throw report::SceneError(
            where, "element " +
                       std::to_string(block.first_element + static_cast<Index>(n) / topology(block.shape).n_nodes) +
                       " names node " + std::to_string(block.node[n]) + " of a mesh of " +
                       std::to_string(mesh.n_nodes()) + " nodes");
  MeshComplaints complaints(where);
  check_regions(mesh, complaints);
  check_nodes(mesh, complaints);
  check_surfaces(mesh, complaints);
  check_doubled_elements(mesh, complaints);
  if (const auto complaint = find_nonconforming(mesh)) complaints.add(*complaint);
  check_elements(mesh, complaints);
  complaints.throw_if_any();
}

MeshParts find_parts(const SolidMesh& mesh) {
  std::vector<Index> parent(static_cast<std::size_t>(mesh.n_nodes()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto up = [&](Index node) -> Index& { return parent[static_cast<std::size_t>(node)]; };
  const auto root = [&](Index node) {
    while (up(node) != node) node = up(node) = up(up(node));
    return node;
  };
  for (Index element = 0; element < mesh.n_elements(); ++element) {
    const auto nodes = mesh.nodes_of(element);
    for (const Index node : nodes) {
      const Index a = root(nodes.front()), b = root(node);
      up(std::max(a, b)) = std::min(a, b);
    }
  }
  MeshParts parts;
  parts.part_of_node.assign(parent.size(), -1);
  const auto part_of = [&](Index node) -> Index& { return parts.part_of_node[static_cast<std::size_t>(node)]; };
  for (Index element = 0; element < mesh.n_elements(); ++element) {
    const Index first = root(mesh.nodes_of(element).front());
    if (part_of(first) < 0) {
      part_of(first) = static_cast<Index>(parts.first_element.size());
      parts.first_element.push_back(element);
    }
    for (const Index node : mesh.nodes_of(element)) part_of(node) = part_of(first);
  }
  return parts;
}

void check_connected(const SolidMesh& mesh, const std::vector<Index>& supported_nodes, const std::string& where) {
  const MeshParts parts = find_parts(mesh);
  if (parts.first_element.size() < 2) return;
  std::vector<bool> is_supported(parts.first_element.size(), false);
  for (const Index node : supported_nodes)
    if (const Index part = parts.part_of_node[static_cast<std::size_t>(node)]; part >= 0)
      is_supported[static_cast<std::size_t>(part)] = true;
  const auto n_free = std::count(is_supported.begin(), is_supported.end(), false);
  if (n_free == 0) return;
  const auto first =
      static_cast<std::size_t>(std::find(is_supported.begin(), is_supported.end(), false) - is_supported.begin());
  throw report::SceneError(where,
                           std::to_string(n_free) + " of the " + std::to_string(is_supported.size()) +
                               " unconnected parts of the mesh have no support; the first begins with " +
                               mesh.describe_element(parts.first_element[first]),
                           "merge the nodes of parts that belong together, or support each part");
}

}  // namespace couplet::solid
