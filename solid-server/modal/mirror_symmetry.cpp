#include "solid-server/modal/mirror_symmetry.hpp"

#include <algorithm>

namespace couplet::solid {

MirrorPlane middle_plane(const SolidMesh& mesh, int axis) {
  const auto along = mesh.node_position.col(axis);
  return {axis, 0.5 * (along.minCoeff() + along.maxCoeff())};
}

std::optional<std::vector<Index>> mirrored_nodes(const SolidMesh& mesh, const MirrorPlane& plane) {
  const Eigen::RowVector3d size = mesh.node_position.colwise().maxCoeff() - mesh.node_position.colwise().minCoeff();
  const double tolerance = 1e-6 * size.norm();  // far below the distance of nodes, above the round-off of mesh files
  // Nodes by their place along a line that is parallel to no plane of nodes of a structured mesh.
  const Eigen::RowVector3d line(0.5377, 0.7411, 0.4019);
  std::vector<std::pair<double, Index>> sorted;
  for (Index n = 0; n < mesh.n_nodes(); ++n) sorted.emplace_back(mesh.node_position.row(n).dot(line), n);
  std::sort(sorted.begin(), sorted.end());

  std::vector<Index> mirrored;
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    Eigen::RowVector3d image = mesh.node_position.row(n);
    image[plane.axis] = 2 * plane.place - image[plane.axis];
    const double place = image.dot(line);
    auto candidate = std::lower_bound(sorted.begin(), sorted.end(), std::pair(place - tolerance, Index{0}));
    const auto is_there = [&] { return (mesh.node_position.row(candidate->second) - image).norm() <= tolerance; };
    while (candidate != sorted.end() && candidate->first <= place + tolerance && !is_there()) ++candidate;
    if (candidate == sorted.end() || !is_there()) return std::nullopt;
    mirrored.push_back(candidate->second);
  }
  return mirrored;
}

Symmetry symmetry_of(const TangentSolver& solver, const Mode& mode, const MirrorPlane& plane,
                     const std::vector<Index>& mirrored) {
  NodeVectors image(mode.shape.rows(), 4);
  for (std::size_t n = 0; n < mirrored.size(); ++n) {
    image.row(mirrored[n]) = mode.shape.row(static_cast<Eigen::Index>(n));
    image(mirrored[n], plane.axis) *= -1;
  }
  constexpr double clear = 0.99;
  const double correlation = image.cwiseProduct(solver.mass_times(mode.shape)).sum();
  return correlation > clear ? Symmetry::symmetric : correlation < -clear ? Symmetry::antisymmetric : Symmetry::neither;
}

}  // namespace couplet::solid
