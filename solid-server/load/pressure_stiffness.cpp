#include "solid-server/load/pressure_stiffness.hpp"

namespace couplet::solid {

namespace {

/// [v]: [v] d = v x d.
Eigen::Matrix3d cross_with(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace

void pressure_stiffness(const FacePacks& faces, double pressure, const NodeVectors& displacement,
                        const TakeStiffness& take) {
  if (pressure == 0) return;
  const auto n_nodes = static_cast<std::size_t>(faces.n_nodes);
  Index node[max_face_nodes];
  Eigen::Matrix<double, 3, max_face_nodes> x;
  for (std::size_t face = 0; face < static_cast<std::size_t>(faces.n_faces); ++face) {
    const std::size_t pack = face / n_lanes, lane = face % n_lanes;
    for (std::size_t a = 0; a < n_nodes; ++a) {
      node[a] = faces.node_start[(pack * n_nodes + a) * n_lanes + lane] / NodeVectors::ColsAtCompileTime;
      for (std::size_t i = 0; i < 3; ++i)
        x(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(a)) =
            faces.position[(pack * n_nodes + a) * 3 + i].lane[lane] +
            displacement(node[a], static_cast<Eigen::Index>(i));
    }
    std::array<Eigen::Matrix3d, max_face_nodes * max_face_nodes> C;
    C.fill(Eigen::Matrix3d::Zero());
    for (int q = 0; q < faces.n_points; ++q) {
      Eigen::Vector3d t[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  // x,xi and x,eta
      for (int a = 0; a < faces.n_nodes; ++a)
        for (int k = 0; k < 2; ++k) t[k] += faces.gradient[q][a][k] * x.col(a);
      const Eigen::Matrix3d along_xi = pressure * faces.weight[q] * cross_with(t[0]);
      const Eigen::Matrix3d along_eta = pressure * faces.weight[q] * cross_with(t[1]);
      for (std::size_t b = 0; b < n_nodes; ++b) {
        const Eigen::Matrix3d change = faces.gradient[q][b][1] * along_xi - faces.gradient[q][b][0] * along_eta;
        for (std::size_t a = 0; a < n_nodes; ++a) C[a * n_nodes + b] += faces.shape[q][a] * change;
      }
    }
    for (std::size_t a = 0; a < n_nodes; ++a)
      for (std::size_t b = 0; b < n_nodes; ++b) take(node[a], node[b], C[a * n_nodes + b]);
  }
}

}  // namespace couplet::solid
