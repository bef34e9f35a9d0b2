#include "solid-server/mesh/wetted_surface.hpp"

#include <algorithm>
#include <map>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

std::int64_t place_of(const std::vector<Index>& nodes, Index node) {
  return std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin();
}

}  // namespace

WettedSurface make_wetted_surface(const SolidMesh& mesh, const std::vector<std::string>& names) {
  WettedSurface wetted;
  surface::SurfaceMesh& out = wetted.surface;
  std::vector<ElementFace> faces;
  std::vector<std::int64_t> regions;
  std::map<std::pair<Index, int>, std::size_t> name_of;  // by element and side
  for (std::size_t r = 0; r < names.size(); ++r) {
    const auto& named = mesh.find_surface(names[r], "wetted");
    for (const ElementFace& face : named)
      if (const auto [before, is_new] = name_of.try_emplace({face.element, face.side}, r); !is_new)
        throw report::SceneError("wetted",
                                 "\"" + names[r] + "\" and \"" + names[before->second] +
                                     "\" have a face in common, which would feel the flow twice",
                                 "name each part of the surface once");
    faces.insert(faces.end(), named.begin(), named.end());
    regions.insert(regions.end(), named.size(), static_cast<std::int64_t>(r));
    out.region.push_back(names[r]);
  }
  wetted.solid_node = nodes_of_faces(mesh, faces);

  out.node_position.resize(static_cast<Eigen::Index>(wetted.solid_node.size()), 3);
  for (Eigen::Index n = 0; n < out.node_position.rows(); ++n)
    out.node_position.row(n) = mesh.node_position.row(wetted.solid_node[static_cast<std::size_t>(n)]);

  const auto n_faces = static_cast<Eigen::Index>(faces.size());
  std::vector<std::int64_t> face_node;
  out.face_offset = surface::IndexArray::Zero(n_faces + 1);
  out.face_region = Eigen::Map<const surface::IndexArray>(regions.data(), n_faces);
  for (Eigen::Index f = 0; f < n_faces; ++f) {
    wetted.face.push_back(mesh.nodes_of(faces[static_cast<std::size_t>(f)]));
    for (const Index node : wetted.face.back()) face_node.push_back(place_of(wetted.solid_node, node));
    out.face_offset[f + 1] = static_cast<std::int64_t>(face_node.size());
  }
  out.face_node = Eigen::Map<const surface::IndexArray>(face_node.data(), static_cast<Eigen::Index>(face_node.size()));
  for (const auto& [name, node] : mesh.marker)
    if (std::binary_search(wetted.solid_node.begin(), wetted.solid_node.end(), node))
      out.marker[name] = place_of(wetted.solid_node, node);
  return wetted;
}

}  // namespace couplet::solid
