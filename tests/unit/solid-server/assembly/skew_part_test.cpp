#include "solid-server/assembly/skew_part.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "solid-server/assembly/minimal_residual.hpp"

namespace couplet::solid {
namespace {

constexpr Index n_nodes = 5;

Eigen::MatrixXd random_matrix(int seed) {
  Eigen::MatrixXd matrix(3 * n_nodes, 3 * n_nodes);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] = std::sin(7.0 * static_cast<double>(i) + seed);
  return matrix;
}

NodeVectors nodes_of(const Eigen::VectorXd& flat) {
  NodeVectors vector = NodeVectors::Zero(n_nodes, 4);
  for (Index n = 0; n < n_nodes; ++n) vector.row(n).head<3>() = flat.segment<3>(3 * n).transpose();
  return vector;
}

Eigen::VectorXd flat_of(const NodeVectors& vector) {
  Eigen::VectorXd flat(3 * n_nodes);
  for (Index n = 0; n < n_nodes; ++n) flat.segment<3>(3 * n) = vector.row(n).head<3>().transpose();
  return flat;
}

void add_all(SkewPart& skew, const Eigen::MatrixXd& matrix) {
  for (Index a = 0; a < n_nodes; ++a)
    for (Index b = 0; b < n_nodes; ++b) skew.add(a, b, matrix.block<3, 3>(3 * a, 3 * b));
}

TEST(SkewPart, IsHalfTheDifferenceFromTheTransposeOnFreeComponents) {
  FreeComponents free = FreeComponents::Constant(n_nodes, 3, true);
  free(1, 0) = free(3, 2) = false;
  Eigen::MatrixXd matrix = random_matrix(1);
  SkewPart skew;
  add_all(skew, matrix);
  skew.complete(free);
  Eigen::MatrixXd expected = (matrix - matrix.transpose()) / 2;
  for (const int held : {3, 11}) expected.row(held).setZero(), expected.col(held).setZero();
  const NodeVectors x = nodes_of(random_matrix(2).col(0));
  NodeVectors sum = NodeVectors::Ones(n_nodes, 4);
  skew.add_product(x, sum);
  // Sums of fifteen terms of size 1.
  EXPECT_LE((flat_of(sum) - Eigen::VectorXd::Ones(15) - expected * flat_of(x)).norm(), 1e-14);
}

TEST(SkewPart, IsZeroWhereContributionsAreSymmetricTogether) {
  const FreeComponents free = FreeComponents::Constant(n_nodes, 3, true);
  const Eigen::MatrixXd matrix = random_matrix(1);
  SkewPart skew;
  add_all(skew, matrix);
  add_all(skew, matrix.transpose());
  skew.complete(free);
  EXPECT_TRUE(skew.is_zero());
  add_all(skew, matrix);
  skew.complete(free);
  EXPECT_FALSE(skew.is_zero());
  skew.clear();
  EXPECT_TRUE(skew.is_zero());
}

TEST(MinimalResidual, SolvesAnUnsymmetricSystemWithTheFactorsOfANearbyOne) {
  const Eigen::MatrixXd nearby =
      random_matrix(1) + random_matrix(1).transpose() + 20 * Eigen::MatrixXd::Identity(15, 15);
  const Eigen::MatrixXd matrix = nearby + 3 * (random_matrix(2) - random_matrix(2).transpose());
  const auto factors = nearby.partialPivLu();
  int n_products = 0;
  const auto multiply = [&](const NodeVectors& x) {
    ++n_products;
    return nodes_of(matrix * flat_of(x));
  };
  const auto solve = [&](const NodeVectors& x) { return nodes_of(factors.solve(flat_of(x))); };
  const NodeVectors b = nodes_of(random_matrix(3).col(0));
  const Eigen::VectorXd exact = matrix.partialPivLu().solve(flat_of(b));
  const auto error = [&](const NodeVectors& x) { return (flat_of(x) - exact).norm() / exact.norm(); };
  const double without = error(solve(b));
  EXPECT_GT(without, 0.1);
  // Exact after as many products as unknowns, up to the condition of the matrix times round-off.
  EXPECT_LE(error(minimal_residual(multiply, solve, b, 1e-13, 15)), 1e-10);
  EXPECT_LE(n_products, 15);
  EXPECT_LE(error(minimal_residual(multiply, solve, b, 1e-3, 15)), 1e-2);
  EXPECT_TRUE(minimal_residual(multiply, solve, nodes_of(Eigen::VectorXd::Zero(15)), 1e-3, 15).isZero(0));
  // Nearby and exact the same: one product.
  n_products = 0;
  const auto multiply_nearby = [&](const NodeVectors& x) {
    ++n_products;
    return nodes_of(nearby * flat_of(x));
  };
  EXPECT_LE((minimal_residual(multiply_nearby, solve, b, 1e-6, 15) - solve(b)).norm(), 1e-12);
  EXPECT_EQ(n_products, 1);
}

}  // namespace
}  // namespace couplet::solid
