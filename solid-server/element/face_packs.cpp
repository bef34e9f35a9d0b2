#include "solid-server/element/face_packs.hpp"

#include <algorithm>

#include "solid-server/element/lane_transpose.hpp"
#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {

namespace {

void tabulate_shape(FaceShape face, FacePacks& packs) {
  const auto points = face_quadrature(face);
  packs.n_nodes = n_nodes_of(face);
  packs.n_points = static_cast<int>(points.size());
  for (std::size_t q = 0; q < points.size(); ++q) {
    const auto shape = shape_values(face, points[q].xi);
    const auto gradient = shape_gradient(face, points[q].xi);
    packs.weight[q] = points[q].weight;
    for (int a = 0; a < packs.n_nodes; ++a) {
      packs.shape[q][a] = shape[a];
      for (int k = 0; k < 2; ++k) packs.gradient[q][a][k] = gradient(a, k);
    }
  }
}

}  // namespace

FacePacks make_face_packs(const SolidMesh& mesh, const std::vector<FaceNodes>& faces) {
  FacePacks packs;
  if (faces.empty()) return packs;
  tabulate_shape(faces.front().shape(), packs);
  packs.n_faces = static_cast<Index>(faces.size());
  packs.n_packs = (packs.n_faces + n_lanes - 1) / n_lanes;
  const auto n_packs = static_cast<std::size_t>(packs.n_packs);
  const auto n_nodes = static_cast<std::size_t>(packs.n_nodes);
  packs.node_start.resize(n_packs * n_nodes * n_lanes);
  packs.position.resize(n_packs * n_nodes * 3);
  for (std::size_t p = 0; p < n_packs; ++p)
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const FaceNodes& nodes = faces[std::min(p * n_lanes + lane, faces.size() - 1)];
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        packs.node_start[(p * nodes.size() + a) * n_lanes + lane] = NodeVectors::ColsAtCompileTime * nodes[a];
        for (std::size_t i = 0; i < 3; ++i)
          packs.position[(p * nodes.size() + a) * 3 + i].lane[lane] =
              mesh.node_position(nodes[a], static_cast<Eigen::Index>(i));
      }
    }
  return packs;
}

std::vector<std::vector<FaceNodes>> group_by_shape(const std::vector<FaceNodes>& faces) {
  std::vector<std::vector<FaceNodes>> groups;
  for (const FaceNodes& face : faces) {
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& known) { return known.front().shape() == face.shape(); });
    if (group == groups.end())
      groups.push_back({face});
    else
      group->push_back(face);
  }
  return groups;
}

Index face_force_start(const FacePacks& packs, Index face, int local_node) {
  const Index pack = face / n_lanes, lane = face % n_lanes;
  return (pack * packs.packs_of_force() + 4 * local_node) * n_lanes + 4 * lane_place(lane);
}

}  // namespace couplet::solid
