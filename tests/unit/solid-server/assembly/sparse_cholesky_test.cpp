#include "solid-server/assembly/sparse_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <numeric>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/elimination_order.hpp"
#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/mesh/box_mesh.hpp"
#include "tests/unit/solid-server/assembly/random_blocks.hpp"

namespace couplet::solid {
namespace {

NodePairs pairs_of_box(int n_x, int n_y, int n_z) {
  return element_pairs(make_box_mesh({{1, 1, 1}, {n_x, n_y, n_z}}));
}

/// Every fifth node is held, the others have one, two or three free components.
FreeComponents some_held(Index n_nodes) {
  FreeComponents free = FreeComponents::Constant(n_nodes, 3, true);
  for (Index n = 0; n < n_nodes; ++n) {
    if (n % 5 == 0) free.row(n).setConstant(false);
    if (n % 7 == 1) free(n, 1) = false;
    if (n % 11 == 2) free(n, 0) = free(n, 2) = false;
  }
  return free;
}

NodeVectors random_vectors(Index n_nodes) {
  NodeVectors vectors = NodeVectors::Zero(n_nodes, 4);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> between(-1, 1);
  for (Index n = 0; n < n_nodes; ++n)
    for (int i = 0; i < 3; ++i) vectors(n, i) = between(random);
  return vectors;
}

Eigen::VectorXd flat(const NodeVectors& vectors, const FreeComponents& free) {
  Eigen::VectorXd out(3 * vectors.rows());
  for (Eigen::Index n = 0; n < out.size(); ++n) out[n] = free(n / 3, n % 3) ? vectors(n / 3, n % 3) : 0.0;
  return out;
}

TEST(Elimination, CountsTheRowsThatEliminationFills) {
  const NodePairs pairs = pairs_of_box(3, 2, 2);
  const Index n = pairs.n_nodes();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  const Elimination found = eliminate(pairs, std::vector<int>(order.size(), 3), order);

  Eigen::MatrixXi is_filled = Eigen::MatrixXi::Zero(n, n);
  for (Index a = 0; a < n; ++a)
    for (Index b = 0; b < n; ++b)
      is_filled(a, b) = pairs.find(order[static_cast<std::size_t>(a)], order[static_cast<std::size_t>(b)]) >= 0;
  double n_operations = 0;
  for (Index j = 0; j < n; ++j) {
    Index parent = -1;
    for (Index a = n - 1; a > j; --a)
      if (is_filled(a, j)) {
        parent = a;
        for (Index b = j + 1; b < n; ++b) is_filled(a, b) |= is_filled(b, j);
      }
    const int n_rows = is_filled.col(j).tail(n - j).sum();
    EXPECT_EQ(found.n_rows[static_cast<std::size_t>(j)], n_rows) << j;
    EXPECT_EQ(found.parent[static_cast<std::size_t>(j)], parent) << j;
    n_operations += 27.0 * n_rows * n_rows;
  }
  EXPECT_EQ(found.n_operations, n_operations);
}

TEST(EliminationOrder, HasEveryFreeNodeOnceAndFewerOperationsThanTheOrderOfTheMesh) {
  const NodePairs pairs = pairs_of_box(5, 5, 5);
  const auto weight = n_free_of_nodes(some_held(pairs.n_nodes()));
  std::vector<Index> found = elimination_order(pairs, weight), mesh_order;
  for (Index n = 0; n < pairs.n_nodes(); ++n)
    if (weight[static_cast<std::size_t>(n)] > 0) mesh_order.push_back(n);
  EXPECT_LT(eliminate(pairs, weight, found).n_operations, 0.7 * eliminate(pairs, weight, mesh_order).n_operations);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, mesh_order);
}

class CholeskyOf : public testing::TestWithParam<double> {};

TEST_P(CholeskyOf, SolvesAndCountsNegativeEigenvalues) {
  const NodePairs pairs = pairs_of_box(4, 3, 3);
  const FreeComponents free = some_held(pairs.n_nodes());
  const std::vector<double> blocks = random_blocks(pairs, GetParam());
  WorkTeam team(2);
  SparseCholesky cholesky(pairs, free, team);
  EXPECT_EQ(cholesky.n_unknowns(), free.count());
  cholesky.factorise(blocks);
  const Eigen::MatrixXd A = dense(pairs, blocks, free);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
  EXPECT_EQ(cholesky.n_negative_pivots(), (eigenvalues.array() < 0).count());

  const NodeVectors b = random_vectors(pairs.n_nodes()), x = cholesky.solve(b);
  const double error = (A * flat(x, free) - flat(b, free)).norm();
  // Round-off; without row exchanges an indefinite matrix loses some more digits.
  EXPECT_LE(error, (GetParam() > 20 ? 1e-13 : 1e-8) * b.norm());
  EXPECT_EQ((x.leftCols<3>().array() * (!free).cast<double>()).abs().maxCoeff(), 0);
}

// Rows have up to 3 * 81 entries below 1: 40 makes the matrix positive definite, 5 leaves some eigenvalues below 0,
// -40 makes all negative.
INSTANTIATE_TEST_SUITE_P(Diagonals, CholeskyOf, testing::Values(40.0, 5.0, -40.0));

TEST(SparseCholesky, GivesTheSameBitsForAnyNumberOfMembers) {
  const NodePairs pairs = pairs_of_box(6, 6, 6);
  const FreeComponents free = some_held(pairs.n_nodes());
  const std::vector<double> blocks = random_blocks(pairs, 5);
  const NodeVectors b = random_vectors(pairs.n_nodes());
  NodeVectors first;
  for (const int n_members : {1, 2, 3}) {
    WorkTeam team(n_members);
    SparseCholesky cholesky(pairs, free, team);
    for (int again = 0; again < 2; ++again) {
      cholesky.factorise(blocks);
      const NodeVectors x = cholesky.solve(b);
      if (n_members == 1) first = x;
      EXPECT_EQ(x, first) << n_members;
    }
  }
}

TEST(SparseCholesky, RefusesAMatrixThatIsSingularOrNotANumberAndNamesTheNode) {
  const NodePairs pairs = pairs_of_box(2, 2, 2);
  const FreeComponents free = FreeComponents::Constant(pairs.n_nodes(), 3, true);
  WorkTeam team(1);
  SparseCholesky cholesky(pairs, free, team);
  const auto message = [&](const std::vector<double>& blocks) -> std::string {
    try {
      cholesky.factorise(blocks);
    } catch (const report::NumericsError& error) {
      return error.what();
    }
    return "accepted";
  };
  std::vector<double> blocks(9 * static_cast<std::size_t>(pairs.n_pairs()), 0);
  for (Index n = 0; n < pairs.n_nodes(); ++n)
    for (const std::size_t i : {0, 4, 8})
      blocks[9 * static_cast<std::size_t>(pairs.start[static_cast<std::size_t>(n)]) + i] = n == 17 && i == 4 ? 0 : 2;
  EXPECT_NE(message(blocks).find("y component of node 17"), std::string::npos) << message(blocks);
  for (double& entry : blocks) entry = entry == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(blocks).find("not a number"), std::string::npos) << message(blocks);
}

}  // namespace
}  // namespace couplet::solid
