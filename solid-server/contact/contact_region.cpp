#include "solid-server/contact/contact_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "solid-server/element/quadrature.hpp"
#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {

namespace {

struct AreaPoint {
  FaceCoordinates at = {0, 0};
  double weight;
};

/// Gauss 2 x 2, or three points of a triangle: they give the exact nodal forces of a uniform pressure on a face with
/// straight edges and evenly spaced nodes, with about as many points as the surface has nodes.
std::vector<AreaPoint> area_points(FaceShape shape) {
  if (shape == FaceShape::triangle6)
    return {{{1.0 / 6, 1.0 / 6}, 1.0 / 6}, {{2.0 / 3, 1.0 / 6}, 1.0 / 6}, {{1.0 / 6, 2.0 / 3}, 1.0 / 6}};
  std::vector<AreaPoint> out;
  for (const auto& q : face_quadrature(shape)) out.push_back({q.xi, q.weight});
  return out;
}

void mark_open_edges(std::vector<ContactFace>& faces) {
  std::map<std::pair<Index, Index>, int> n_faces_at;
  const auto ends = [](const ContactFace& face, std::size_t k) {
    const auto n_corners = static_cast<std::size_t>(n_corners_of(face.shape));
    return std::minmax(face.node[k], face.node[(k + 1) % n_corners]);
  };
  const auto for_each_edge = [&](const auto& visit) {
    for (ContactFace& face : faces)
      for (std::size_t k = 0; k < static_cast<std::size_t>(n_corners_of(face.shape)); ++k)
        visit(face, k, std::pair<Index, Index>(ends(face, k)));
  };
  std::vector<Index> open_node;
  for_each_edge([&](ContactFace&, std::size_t, const auto& edge) { ++n_faces_at[edge]; });
  for_each_edge([&](ContactFace& face, std::size_t k, const auto& edge) {
    face.is_open_edge[k] = n_faces_at[edge] == 1;
    if (face.is_open_edge[k]) open_node.insert(open_node.end(), {edge.first, edge.second});
  });
  std::sort(open_node.begin(), open_node.end());
  for_each_edge([&](ContactFace& face, std::size_t k, const auto&) {
    face.is_open_corner[k] = std::binary_search(open_node.begin(), open_node.end(), face.node[k]);
  });
}

/// Patches are numbered by their lowest node.
void number_patches(std::vector<ContactFace>& faces, std::size_t n_contact_nodes) {
  std::vector<Index> patch(n_contact_nodes);
  std::iota(patch.begin(), patch.end(), 0);
  const auto nodes_of = [](const ContactFace& face) {
    return std::span(face.node).first(static_cast<std::size_t>(n_nodes_of(face.shape)));
  };
  bool is_changed = true;
  while (is_changed) {  // the lowest number spreads; paths are shortened, so that a few sweeps do
    is_changed = false;
    for (const ContactFace& face : faces) {
      Index lowest = std::numeric_limits<Index>::max();
      for (const Index n : nodes_of(face)) {
        Index& own = patch[static_cast<std::size_t>(n)];
        own = patch[static_cast<std::size_t>(own)];
        lowest = std::min(lowest, own);
      }
      for (const Index n : nodes_of(face)) {
        const Index before = patch[static_cast<std::size_t>(n)];
        if (before == lowest) continue;
        patch[static_cast<std::size_t>(before)] = patch[static_cast<std::size_t>(n)] = lowest;
        is_changed = true;
      }
    }
  }
  for (ContactFace& face : faces) face.patch = patch[static_cast<std::size_t>(face.node[0])];
}

}  // namespace

CurvedFace ContactFace::curved(const ContactPositions& x) const {
  std::array<NodeQuad, max_face_nodes> position;
  for (std::size_t a = 0; a < max_face_nodes; ++a) position[a] = x[static_cast<std::size_t>(node[a])];
  return {shape, position};
}

NodeQuad ContactFace::middle(const ContactPositions& x) const {
  const int n_corners = n_corners_of(shape);
  NodeQuad sum{};
  for (int a = 0; a < n_corners; ++a) sum += x[static_cast<std::size_t>(node[static_cast<std::size_t>(a)])];
  return sum / static_cast<double>(n_corners);
}

NodeQuad ContactRegion::position(const ContactPoint& p, const ContactPositions& x) const {
  const ContactFace& own = face[static_cast<std::size_t>(p.face)];
  NodeQuad sum{};
  for (std::size_t a = 0; a < max_face_nodes; ++a) sum += p.shape[a] * x[static_cast<std::size_t>(own.node[a])];
  return sum;
}

ContactRegion make_contact_region(const std::vector<FaceNodes>& faces, const std::vector<Index>& contact_node,
                                  const ContactPositions& rest) {
  ContactRegion region;
  for (const FaceNodes& nodes : faces) {
    ContactFace face;
    face.shape = nodes.shape();
    for (std::size_t a = 0; a < nodes.size(); ++a) face.node[a] = contact_node[static_cast<std::size_t>(nodes[a])];
    region.node.insert(region.node.end(), face.node.begin(), face.node.begin() + static_cast<int>(nodes.size()));
    const CurvedFace curved = face.curved(rest);
    for (const AreaPoint& q : area_points(face.shape)) {
      const FacePoint at = curved.at(q.at);
      const NodeQuad normal = cross(at.tangent_xi, at.tangent_eta);
      ContactPoint point{static_cast<Index>(region.face.size()), {}, q.weight * std::sqrt(dot(normal, normal))};
      const auto shape = shape_values(face.shape, q.at);
      std::copy(shape.begin(), shape.end(), point.shape.begin());
      region.point.push_back(point);
    }
    region.face.push_back(face);
  }
  std::sort(region.node.begin(), region.node.end());
  region.node.erase(std::unique(region.node.begin(), region.node.end()), region.node.end());
  mark_open_edges(region.face);
  number_patches(region.face, rest.size());
  return region;
}

}  // namespace couplet::solid
