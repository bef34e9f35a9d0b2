#include "solid-server/assembly/tangent_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/dynamics/nodal_force.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"

namespace couplet::solid {
namespace {

/// A bar of two materials, 5 x 2 x 3 elements with curved edges.
SolidMesh bar() {
  SolidMesh mesh = make_box_mesh({{5, 2, 3}, {5, 2, 3}});
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    mesh.node_position.row(n) += 0.03 * Eigen::RowVector3d(std::sin(n), std::cos(3 * n), std::sin(2 * n));
  ElementBlock& first = mesh.block[0];
  first.n_elements_per_layer = 0;
  ElementBlock second = first;
  const auto half = first.node.begin() + 13 * 20;
  second.node.assign(half, first.node.end());
  second.first_element = 13;
  first.node.erase(half, first.node.end());
  mesh.block.push_back(second);
  return mesh;
}

std::vector<BlockProperties> two_materials() {
  return {{SaintVenantKirchhoff::from_young(15e3, 0.3), 1000, 8}, {MooneyRivlin{2290, 250, 50e3}, 1200, 14}};
}

FreeComponents all_free(const SolidMesh& mesh) {
  return FreeComponents::Constant(mesh.n_nodes(), 3, true);
}

/// Held at x = 0; one more component of one node.
FreeComponents clamped(const SolidMesh& mesh) {
  FreeComponents free = all_free(mesh);
  for (const Index n : nodes_of_faces(mesh, mesh.find_surface("x_min", ""))) free.row(n).setConstant(false);
  free(mesh.n_nodes() - 1, 2) = false;
  return free;
}

NodeVectors wavy(const SolidMesh& mesh, double size) {
  NodeVectors displacement = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) {
    const Eigen::Vector3d X = mesh.node_position.row(n);
    displacement.row(n) << size * std::sin(X.y() + X.z()), 0.8 * size * X.x() * std::cos(X.z()),
        0.5 * size * X.x() * X.y(), 0;
  }
  return displacement;
}

NodeVectors scattered(const SolidMesh& mesh) {
  NodeVectors vectors = NodeVectors::Zero(mesh.n_nodes(), 4);
  for (Index n = 0; n < mesh.n_nodes(); ++n) vectors.row(n) << std::sin(5 * n), std::cos(7 * n), std::sin(11 * n), 0;
  return vectors;
}

NodeVectors internal_force(const SolidMesh& mesh, const NodeVectors& displacement) {
  return NodalForce(mesh, two_materials(), ExternalForce(mesh, {}, {}, {}), 1).internal_only(displacement);
}

double largest(const NodeVectors& vectors) {
  return vectors.cwiseAbs().maxCoeff();
}

TEST(TangentSolver, MultipliesByMinusTheDerivativeOfTheForce) {
  const SolidMesh mesh = bar();
  WorkTeam team(2);
  TangentSolver solver(mesh, two_materials(), all_free(mesh), team);
  const NodeVectors u = wavy(mesh, 0.05), d = scattered(mesh);
  EXPECT_EQ(solver.assemble(u, {2, 0}), -1);
  const double h = 1e-6;  // of unit lengths: truncation 1e-9 and round-off 1e-9 of the stiffness
  const NodeVectors slope = (internal_force(mesh, u - h * d) - internal_force(mesh, u + h * d)) / (2 * h);
  const NodeVectors product = solver.multiply(d);
  EXPECT_LE(largest(product - 2 * slope), 1e-7 * largest(product));
}

TEST(TangentSolver, FeelsNoRigidMotion) {
  const SolidMesh mesh = bar();
  WorkTeam team(1);
  TangentSolver solver(mesh, two_materials(), all_free(mesh), team);
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  NodeVectors turned = NodeVectors::Zero(mesh.n_nodes(), 4), spin = turned, shift = turned;
  turned.leftCols<3>() = mesh.node_position * (Q - Eigen::Matrix3d::Identity()).transpose();
  shift.leftCols<3>().rowwise() = Eigen::RowVector3d(1, -2, 3);
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    spin.row(n).head<3>() = Eigen::Vector3d(1, -1, 2).cross(Q * mesh.node_position.row(n).transpose());
  solver.assemble(turned, {1, 0});
  const double size = largest(solver.multiply(scattered(mesh)));
  EXPECT_LE(largest(solver.multiply(shift)), 1e-13 * size);
  EXPECT_LE(largest(solver.multiply(spin)), 1e-12 * size);
}

TEST(TangentSolver, HasTheMassOfTheBody) {
  const SolidMesh mesh = make_box_mesh({{2, 3, 1}, {4, 2, 2}});
  WorkTeam team(1);
  TangentSolver solver(mesh, {{SaintVenantKirchhoff::from_young(15e3, 0.3), 1000, 8}}, all_free(mesh), team);
  NodeVectors shift = NodeVectors::Zero(mesh.n_nodes(), 4), linear = shift;
  shift.col(1).setOnes();
  linear.col(1) = mesh.node_position.col(0);
  const NodeVectors product = solver.mass_times(shift);
  EXPECT_NEAR(product.col(1).sum(), 6000, 1e-9);
  EXPECT_NEAR(product.cwiseProduct(linear).sum(), 6000 * 1.0, 1e-9);              // first moment, at the centre
  EXPECT_NEAR(solver.mass_times(linear).cwiseProduct(linear).sum(), 8000, 1e-9);  // second: rho 3 * 1 * 2^3 / 3
  EXPECT_EQ(largest(NodeVectors(product.leftCols<1>().replicate<1, 4>())), 0);    // no coupling of components
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {0, 3});
  EXPECT_LE(largest(solver.multiply(linear) - 3 * solver.mass_times(linear)), 1e-12 * 6000);
}

TEST(TangentSolver, SolvesForTheFreeComponents) {
  const SolidMesh mesh = bar();
  const FreeComponents free = clamped(mesh);
  WorkTeam team(2);
  TangentSolver solver(mesh, two_materials(), free, team);
  EXPECT_EQ(solver.n_free(), free.count());
  solver.assemble(wavy(mesh, 0.02), {1, 1e4});
  solver.factorise();
  EXPECT_EQ(solver.n_negative_pivots(), 0);
  const NodeVectors b = scattered(mesh), x = solver.solve(b);
  const NodeVectors is_free =
      (NodeVectors(mesh.n_nodes(), 4) << free.cast<double>(), Eigen::VectorXd::Zero(mesh.n_nodes())).finished();
  EXPECT_LE(largest(solver.multiply(x) - b.cwiseProduct(is_free)), 1e-11);  // round-off of unit loads
  EXPECT_EQ(largest(x - x.cwiseProduct(is_free)), 0);
  EXPECT_EQ(solver.cost().n_factorisations, 1);
  EXPECT_EQ(solver.cost().n_solves, 1);
}

TEST(TangentSolver, TakesContributionsBetweenAnyNodes) {
  const SolidMesh mesh = bar();
  const FreeComponents free = clamped(mesh);
  WorkTeam team(1);
  TangentSolver solver(mesh, two_materials(), free, team);
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {1, 0});
  const NodeVectors d = scattered(mesh), before = solver.multiply(d);
  const Index near = 40, far = mesh.n_nodes() - 2;  // in no common element
  const Eigen::Matrix3d C = (Eigen::Matrix3d() << 5e4, 1e3, 2e3, -3e3, 6e4, 4e3, 7e3, -2e3, 8e4).finished();
  solver.add(near, near, C);
  solver.add(near, far, -C);
  solver.add(far, near, -C);
  solver.add(far, far, C);
  // The symmetric part of a spring between the two nodes.
  NodeVectors expected = before;
  const Eigen::RowVector3d force = (d.row(near) - d.row(far)).head<3>() * 0.5 * (C + C.transpose());
  expected.row(near).head<3>() += force.cwiseProduct(free.row(near).cast<double>().matrix());
  expected.row(far).head<3>() -= force.cwiseProduct(free.row(far).cast<double>().matrix());
  EXPECT_LE(largest(solver.multiply(d) - expected), 1e-12 * largest(expected));
  solver.factorise();
  EXPECT_LE(largest(solver.multiply(d) - expected), 1e-12 * largest(expected));
  NodeVectors d_free = d;
  d_free.leftCols<3>().array() *= free.cast<double>();
  EXPECT_LE(largest(solver.solve(solver.multiply(d_free)) - d_free), 1e-10);  // round-off times the condition number
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {1, 0});
  EXPECT_EQ(solver.multiply(d), before);  // forgotten, though the pattern has grown
  solver.add(near, near, C);              // another pair instead
  solver.add(far - 40, far - 40, C);
  solver.add(near, far - 40, -C);
  solver.add(far - 40, near, -C);
  const NodeVectors after = solver.multiply(d_free);
  solver.factorise();
  EXPECT_LE(largest(solver.solve(after) - d_free), 1e-10);
}

TEST(TangentMatrix, KeepsItsEntriesWhenThePatternChanges) {
  const SolidMesh mesh = bar();
  WorkTeam team(1);
  TangentMatrix matrix(mesh, two_materials(), MassForm::consistent, team);
  matrix.assemble(wavy(mesh, 0.02), nullptr, 1, 10);
  const NodeVectors d = scattered(mesh), before = matrix.multiply(d);
  const Index n_pairs = matrix.pairs().n_pairs(), last = mesh.n_nodes() - 1;
  EXPECT_TRUE(matrix.is_zero(0, last));
  EXPECT_FALSE(matrix.is_zero(0, 1));
  EXPECT_FALSE(matrix.add_symmetric_part(last, 0, Eigen::Matrix3d::Ones()));
  for (const Index other : {Index{0}, Index{3}}) {
    matrix.set_extra_pairs({{last, other}, {1, 0}});  // the second one is that of an element
    EXPECT_EQ(matrix.pairs().n_pairs(), n_pairs + 1);
    EXPECT_TRUE(matrix.is_zero(last, other));
    EXPECT_EQ(matrix.multiply(d), before);
    EXPECT_TRUE(matrix.add_symmetric_part(other, last, Eigen::Matrix3d::Ones()));
    EXPECT_FALSE(matrix.is_zero(last, other));
    matrix.assemble(wavy(mesh, 0.02), nullptr, 1, 10);
    EXPECT_EQ(matrix.multiply(d), before);
  }
}

TEST(TangentSolver, GivesTheSameBitsForAnyNumberOfMembers) {
  const SolidMesh mesh = bar();
  const NodeVectors u = wavy(mesh, 0.02), b = scattered(mesh);
  NodeVectors product, solution;
  for (const int n_members : {1, 2, 3}) {
    WorkTeam team(n_members);
    TangentSolver solver(mesh, two_materials(), clamped(mesh), team);
    solver.assemble(u, {1, 10});
    solver.factorise();
    if (n_members == 1) {
      product = solver.multiply(b);
      solution = solver.solve(b);
    }
    EXPECT_EQ(solver.multiply(b), product) << n_members;
    EXPECT_EQ(solver.solve(b), solution) << n_members;
  }
}

TEST(TangentSolver, RefusesABodyThatIsNotHeld) {
  const SolidMesh mesh = bar();
  WorkTeam team(1);
  TangentSolver solver(mesh, two_materials(), all_free(mesh), team);
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {1, 0});
  EXPECT_THROW(solver.factorise(), report::NumericsError);
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {1, 1});
  solver.factorise();
  EXPECT_EQ(solver.n_negative_pivots(), 0);
  solver.assemble(NodeVectors::Zero(mesh.n_nodes(), 4), {1, -1e-2});  // only the rigid motions are below that
  solver.factorise();
  EXPECT_EQ(solver.n_negative_pivots(), 6);
  EXPECT_THROW(TangentSolver(mesh, two_materials(), FreeComponents::Constant(mesh.n_nodes(), 3, false), team),
               report::SceneError);
}

TEST(TangentSolver, KeepsNoTraceOfPairsThatAreGone) {
  const SolidMesh mesh = bar();
  WorkTeam team(1);
  TangentSolver used(mesh, two_materials(), clamped(mesh), team), fresh(mesh, two_materials(), clamped(mesh), team);
  const NodeVectors displacement = wavy(mesh, 0.02);
  used.assemble(displacement, {1, 1e4}, nullptr);
  const Index a = 0, b = mesh.n_nodes() - 1;
  for (const auto& [m, n] : {std::pair{a, b}, std::pair{b, a}}) used.add(m, n, -Eigen::Matrix3d::Identity());
  used.factorise();  // with a pair that no element has
  for (TangentSolver* const solver : {&used, &fresh}) {
    solver->assemble(displacement, {1, 1e4}, nullptr);
    solver->factorise();
  }
  EXPECT_EQ(used.memory_bytes(), fresh.memory_bytes());
  EXPECT_EQ(used.solve(scattered(mesh)), fresh.solve(scattered(mesh)));
}

}  // namespace
}  // namespace couplet::solid
