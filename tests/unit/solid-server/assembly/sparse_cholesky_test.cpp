#include "solid-server/assembly/sparse_cholesky.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/support/symmetric_eigenvalues.hpp"
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

class CholeskyOf : public testing::TestWithParam<double> {};

TEST_P(CholeskyOf, SolvesAndCountsNegativeEigenvalues) {
  const NodePairs pairs = pairs_of_box(4, 3, 3);
  const FreeComponents free = some_held(pairs.n_nodes());
  const std::vector<double> blocks = random_blocks(pairs, GetParam());
  SparseCholesky cholesky(pairs, free);
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

TEST(SparseCholesky, GoesBetweenDefiniteAndIndefiniteMatricesWithTheSameBits) {
  const NodePairs pairs = pairs_of_box(3, 3, 3);
  const FreeComponents free = some_held(pairs.n_nodes());
  SparseCholesky cholesky(pairs, free);
  const NodeVectors b = random_vectors(pairs.n_nodes());
  const auto solve = [&](double diagonal) {
    cholesky.factorise(random_blocks(pairs, diagonal));
    return cholesky.solve(b);
  };
  const NodeVectors definite = solve(40), indefinite = solve(5);
  EXPECT_EQ(solve(40), definite);
  EXPECT_EQ(cholesky.n_negative_pivots(), 0);
  EXPECT_EQ(solve(5), indefinite);
  EXPECT_GT(cholesky.n_negative_pivots(), 0);
}

TEST(SparseCholesky, RefusesAMatrixThatIsSingularOrNotANumber) {
  const NodePairs pairs = pairs_of_box(2, 2, 2);
  const FreeComponents free = FreeComponents::Constant(pairs.n_nodes(), 3, true);
  SparseCholesky cholesky(pairs, free);
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
  EXPECT_NE(message(blocks).find("is singular"), std::string::npos) << message(blocks);
  for (double& entry : blocks) entry = entry == 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(blocks).find("not a finite number"), std::string::npos) << message(blocks);
}

}  // namespace
}  // namespace couplet::solid
