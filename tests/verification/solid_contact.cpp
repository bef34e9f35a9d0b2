// Claims about contact: stress passed through a contact, impact of two blocks, cost of contact that is not there.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "solid-server/contact/surface_contact.hpp"
#include "solid-server/element/tangent.hpp"
#include "solid-server/mesh/box_mesh.hpp"
#include "solid-server/support/supports.hpp"

namespace couplet::solid {
namespace {

const SaintVenantKirchhoff rubber = SaintVenantKirchhoff::from_young(15e3, 0.3);

/// Two blocks of 1 x 1 x 0.5, one on the other, with n_below and n_above elements along x and y.
SolidMesh stack(int n_below, int n_above) {
  SolidMesh below = make_box_mesh({{1, 1, 0.5}, {n_below, n_below, 1}});
  SolidMesh above = make_box_mesh({{1, 1, 0.5}, {n_above, n_above, 1}});
  above.node_position.col(2).array() += 0.5;
  return join_bodies({below, above}, {"below", "above"});
}

/// Newton for the stack with symmetry planes x = 0, y = 0, z = 0, its top moved down by `drop` in one step; dense, for
/// few nodes. (n_nodes, 4) [m].
NodeVectors press(const SolidMesh& mesh, const Material& material, SurfaceContact& contact, double drop) {
  const NodeVectors free = inverse_mass(mesh, Eigen::VectorXd::Ones(mesh.n_nodes()),
                                        {{},
                                         {{"below/x_min", 0},
                                          {"above/x_min", 0},
                                          {"below/y_min", 1},
                                          {"above/y_min", 1},
                                          {"below/z_min", 2},
                                          {"above/z_max", 2}}});
  NodeVectors u = NodeVectors::Zero(mesh.n_nodes(), 4);
  u.col(2) = -drop * mesh.node_position.col(2);
  for (int step = 0; step < 30; ++step) {
    NodeVectors force = NodeVectors::Zero(mesh.n_nodes(), 4);
    contact.add(u.data(), force.data());
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * mesh.n_nodes(), 3 * mesh.n_nodes());
    for (Index e = 0; e < mesh.n_elements(); ++e) {
      const auto nodes = mesh.nodes_of(e);
      const PlainElement element{material, ElementShape::hexahedron20, 27, at_element(mesh.node_position, nodes)};
      const ElementVectors u_e = at_element(u, nodes), f_e = element_force(element, u_e);
      const ElementTangent K_e = element_tangent(element, u_e);
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const auto i = static_cast<Eigen::Index>(a);
        force.row(nodes[a]).head<3>() += f_e.row(i);
        for (std::size_t b = 0; b < nodes.size(); ++b)
          K.block<3, 3>(3 * nodes[a], 3 * nodes[b]) += K_e.block<3, 3>(3 * i, 3 * static_cast<Eigen::Index>(b));
      }
    }
    for (const auto& term : contact.stiffness(u.data()))
      for (std::size_t a = 0; a < static_cast<std::size_t>(term.n_nodes); ++a)
        for (std::size_t b = 0; b < static_cast<std::size_t>(term.n_nodes); ++b)
          K.block<3, 3>(3 * term.node[a], 3 * term.node[b]) +=
              term.stiffness * term.weight[a] * term.weight[b] * term.direction * term.direction.transpose();
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(K.rows());
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      for (int i = 0; i < 3; ++i) {
        const Index row = 3 * n + i;
        rhs[row] = force(n, i);
        if (free(n, i) > 0) continue;
        K.row(row).setZero();
        K.col(row).setZero();
        K(row, row) = 1;
        rhs[row] = 0;
      }
    const Eigen::VectorXd change = K.ldlt().solve(rhs);
    for (Index n = 0; n < mesh.n_nodes(); ++n) u.row(n).head<3>() += change.segment<3>(3 * n);
    if (change.cwiseAbs().maxCoeff() < 1e-13) return u;
  }
  ADD_FAILURE() << "Newton has not converged";
  return u;
}

struct StressRange {
  double smallest, largest;  // P_zz at the quadrature points of all elements [Pa]
};

StressRange stress_range(const SolidMesh& mesh, const SaintVenantKirchhoff& material, const NodeVectors& u) {
  StressRange range{1e300, -1e300};
  for (Index e = 0; e < mesh.n_elements(); ++e) {
    const auto nodes = mesh.nodes_of(e);
    for (const auto& point : element_quadrature(ElementShape::hexahedron20, 8)) {
      const auto at = reference_point(ElementShape::hexahedron20, at_element(mesh.node_position, nodes), point);
      const double P = material.stress(deformation_gradient(at_element(u, nodes), at)).at[2][2];
      range = {std::min(range.smallest, P), std::max(range.largest, P)};
    }
  }
  return range;
}

TEST(ContactPatch, UniformStress) {
  for (const auto& [n_below, n_above] :
       {std::pair(2, 2), std::pair(2, 3), std::pair(3, 2), std::pair(1, 3), std::pair(4, 3)})
    for (const bool is_symmetric : {true, false}) {
      const SolidMesh mesh = stack(n_below, n_above);
      SurfaceContact contact(mesh, {{"above/z_min", "below/z_max", 10 * 15e3 / 0.5, 0.01, 0.2, is_symmetric}});
      const NodeVectors u = press(mesh, rubber, contact, 0.02);
      const StressRange P = stress_range(mesh, rubber, u);
      std::printf("%d on %d, %s: P_zz %.6g to %.6g: %.2e\n", n_above, n_below, is_symmetric ? "symmetric" : "one-sided",
                  P.smallest, P.largest, (P.largest - P.smallest) / std::abs(P.largest + P.smallest));
    }
}

}  // namespace
}  // namespace couplet::solid
