#include "solid-server/element/face_packs.hpp"

#include <algorithm>

#include "solid-server/element/hex20.hpp"
#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

void tabulate_shape(FacePacks& packs) {
  const auto points = face_quadrature();
  for (std::size_t q = 0; q < points.size(); ++q) {
    const auto shape = hex20::face_shape(points[q].xi);
    const auto gradient = hex20::face_shape_gradient(points[q].xi);
    packs.weight[q] = points[q].weight;
    for (int a = 0; a < hex20::n_face_nodes; ++a) {
      packs.shape[q][a] = shape[a];
      for (int k = 0; k < 2; ++k) packs.gradient[q][a][k] = gradient(a, k);
    }
  }
}

}  // namespace

FacePacks make_face_packs(const SolidMesh& mesh, const std::vector<FaceNodes>& faces) {
  FacePacks packs;
  tabulate_shape(packs);
  packs.n_faces = static_cast<Index>(faces.size());
  packs.n_packs = (packs.n_faces + n_lanes - 1) / n_lanes;
  const auto n_packs = static_cast<std::size_t>(packs.n_packs);
  packs.node_start.resize(n_packs * hex20::n_face_nodes * n_lanes);
  packs.position.resize(n_packs * hex20::n_face_nodes * 3);
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

Index face_force_start(Index face, int local_node) {
  const Index pack = face / n_lanes, lane = face % n_lanes;
  return (pack * packs_per_face_pack + 4 * local_node) * n_lanes + 4 * lane_place(lane);
}

}  // namespace couplet::solid
