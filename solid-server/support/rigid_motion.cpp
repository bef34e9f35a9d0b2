#include "solid-server/support/rigid_motion.hpp"

#include <Eigen/QR>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"

namespace couplet::solid {

namespace {

using RigidMotion = Eigen::Matrix<double, 6, 1>;  // shift, turn times length

constexpr double round_off = 1e-10;

std::string name_of(const Eigen::Vector3d& direction) {
  constexpr const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    if (std::abs(direction[i]) > 1 - 1e-6) return axes[i];
  std::string text;
  for (int i = 0; i < 3; ++i) text += (i > 0 ? ", " : "(") + report::text(std::round(direction[i] * 1e3) / 1e3);
  return text + ")";
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n)
    text += (n == 0 ? "" : n + 1 == names.size() ? " and " : ", ") + names[n];
  return text;
}

/// "shift along x and y and turn about z", or nothing.
std::string free_motions(const SolidMesh& mesh, const FreeComponents& free, const std::vector<Index>& nodes) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Index n : nodes) centre += mesh.node_position.row(n).transpose() / static_cast<double>(nodes.size());
  double length = 0;
  for (const Index n : nodes) length = std::max(length, (mesh.node_position.row(n).transpose() - centre).norm());
  // What a motion (t, w) does to the held components, t + w x (X - centre), has to vanish.
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(6, 6);
  bool may_shift[3] = {true, true, true};
  for (const Index n : nodes)
    for (int i = 0; i < 3; ++i) {
      if (free(n, i)) continue;
      may_shift[i] = false;
      const Eigen::Vector3d arm = (mesh.node_position.row(n).transpose() - centre) / length;
      RigidMotion row;
      row << Eigen::Vector3d::Unit(i), arm.cross(Eigen::Vector3d::Unit(i));
      held += row.lazyProduct(row.transpose());
    }
  std::vector<std::string> shifts, turns;
  for (int i = 0; i < 3; ++i)
    if (may_shift[i]) shifts.push_back(name_of(Eigen::Vector3d::Unit(i)));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(held);
  const double largest = modes.eigenvalues()[5];
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();  // projection onto the axes of free turns, summed
  for (int m = 0; m < 6; ++m)
    if (modes.eigenvalues()[m] <= round_off * largest) {
      const Eigen::Vector3d turn = modes.eigenvectors().col(m).tail<3>();
      axes += turn * turn.transpose();
    }
  const Eigen::ColPivHouseholderQR<Eigen::Matrix3d> span(axes);
  const int n_turns = static_cast<int>(span.nonzeroPivots() == 0 || axes.norm() < round_off ? 0 : span.rank());
  if (n_turns == 3) {
    turns = {"every axis"};
  } else {
    const Eigen::Matrix3d Q = span.householderQ();
    for (int k = 0; k < n_turns; ++k) turns.push_back(name_of(Q.col(k)));
  }
  std::string text = shifts.empty() ? "" : "shift along " + joined(shifts);
  if (!turns.empty()) text += (text.empty() ? "" : " and ") + ("turn about " + joined(turns));
  return text;
}

}  // namespace

void check_rigid_motion(const SolidMesh& mesh, const FreeComponents& free, const std::string& where) {
  const MeshParts parts = find_parts(mesh);
  std::vector<std::vector<Index>> nodes(parts.first_element.size());
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    if (const Index part = parts.part_of_node[static_cast<std::size_t>(n)]; part >= 0)
      nodes[static_cast<std::size_t>(part)].push_back(n);
  for (std::size_t part = 0; part < nodes.size(); ++part) {
    const std::string motions = free_motions(mesh, free, nodes[part]);
    if (motions.empty()) continue;
    const std::string which =
        nodes.size() == 1 ? "the body" : "the part with " + mesh.describe_element(parts.first_element[part]);
    throw report::SceneError(where, which + " can " + motions + " as a whole: statics cannot say where it stands",
                             "hold it by fixed, symmetry or prescribed_motion, or choose GENERALIZED_ALPHA");
  }
}

}  // namespace couplet::solid
