#include <gtest/gtest.h>

#include <Eigen/QR>
#include <numeric>
#include <vector>

#include "coupler/acceleration/difference_basis.hpp"
#include "coupler/acceleration/least_squares.hpp"

namespace couplet::coupling {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns that a run would give: newest first, later ones many orders smaller.
MatrixXd columns_of_falling_size(Index n_rows, Index n) {
  std::srand(3);
  MatrixXd columns = MatrixXd::Random(n_rows, n);
  for (Index k = 0; k < n; ++k) columns.col(k) *= std::pow(10., -static_cast<double>(n - 1 - k) / 3);
  return columns;
}

MatrixXd product(const DifferenceBasis& basis, Index n_rows) {
  MatrixXd v(n_rows, basis.n_columns());
  for (Index k = 0; k < v.cols(); ++k) {
    VectorXd column = VectorXd::Zero(n_rows);
    basis.add_combination(basis.coefficients().col(k), column);
    v.col(k) = column;
  }
  return v;
}

void expect_columns(const DifferenceBasis& basis, const MatrixXd& expected) {
  const MatrixXd v = product(basis, expected.rows());
  ASSERT_EQ(v.cols(), expected.cols());
  // Each column to round-off of its own size: small ones must not drown in large ones.
  for (Index k = 0; k < v.cols(); ++k)
    EXPECT_LT((v.col(k) - expected.col(k)).norm(), 1e-12 * expected.col(k).norm()) << k;
}

TEST(DifferenceBasis, HoldsTheColumnsNewestFirst) {
  const MatrixXd v = columns_of_falling_size(700, 12);  // more than one block of rows
  DifferenceBasis basis(700, 20);
  const VectorXd residual = VectorXd::Random(700);
  for (Index k = 11; k >= 0; --k) basis.add(v.col(k), residual);
  expect_columns(basis, v);
}

TEST(DifferenceBasis, KeepsTheOthersWhenColumnsAreDropped) {
  const MatrixXd v = columns_of_falling_size(700, 12);
  DifferenceBasis basis(700, 20);
  const VectorXd residual = VectorXd::Random(700);
  for (Index k = 11; k >= 0; --k) basis.add(v.col(k), residual);
  basis.keep({0, 3, 4, 10});
  MatrixXd expected(700, 4);
  expected << v.col(0), v.col(3), v.col(4), v.col(10);
  expect_columns(basis, expected);
}

TEST(DifferenceBasis, StaysTheSameThroughManyColumnsAndCompressions) {
  const Index columns_max = 6;
  const MatrixXd all = columns_of_falling_size(300, 60);
  DifferenceBasis basis(300, columns_max);
  const VectorXd residual = VectorXd::Random(300);
  for (Index k = 59; k >= 0; --k) {
    basis.add(all.col(k), residual);
    if (basis.n_columns() > columns_max) basis.keep({0, 1, 2, 3, 4, 5});
    EXPECT_LE(basis.coefficients().rows(), columns_max + 5);  // the basis does not grow without end
  }
  expect_columns(basis, all.leftCols(columns_max));
}

TEST(DifferenceBasis, GivesTheProjectionThatTheResultingBasisHas) {
  const MatrixXd v = columns_of_falling_size(300, 5);
  DifferenceBasis basis(300, 20);
  const VectorXd residual = VectorXd::Random(300);
  for (Index k = 4; k >= 0; --k) {
    const VectorXd projected = basis.add(v.col(k), residual);
    EXPECT_LT((projected - basis.project(residual)).norm(), 1e-13 * residual.norm());  // round-off of a sum of 300
  }
}

TEST(DifferenceBasis, AddsNoDirectionForAColumnItKnows) {
  const MatrixXd v = columns_of_falling_size(300, 3);
  DifferenceBasis basis(300, 20);
  const VectorXd residual = VectorXd::Random(300);
  for (Index k = 2; k >= 0; --k) basis.add(v.col(k), residual);
  basis.add(v.col(0) - 2 * v.col(1), residual);
  EXPECT_EQ(basis.coefficients().rows(), 3);
  EXPECT_EQ(basis.n_columns(), 4);
}

TEST(LeastSquares, AgreesWithADenseSolution) {
  const MatrixXd v = columns_of_falling_size(40, 6);
  const VectorXd residual = VectorXd::Random(40);
  const TriangularFactor factor = factorise(v, 1e-3);
  ASSERT_EQ(factor.kept.size(), 6u);
  const VectorXd expected = v.colPivHouseholderQr().solve(-residual);
  EXPECT_LT((minimise(factor, residual) - expected).norm(), 1e-9 * expected.norm());  // condition number 1e2
}

TEST(LeastSquares, DropsColumnsThatDependOnNewerOnes) {
  MatrixXd v = columns_of_falling_size(40, 5);
  v.col(3) = 2 * v.col(1) + 1e-5 * v.col(1).norm() * VectorXd::Unit(40, 0);
  EXPECT_EQ(factorise(v, 1e-3).kept, (std::vector<Index>{0, 1, 2, 4}));
  EXPECT_EQ(factorise(v, 0).kept.size(), 5u);
  v.col(3) = 2 * v.col(1);
  EXPECT_EQ(factorise(v, 0).kept, (std::vector<Index>{0, 1, 2, 4}));
  v.col(0).setZero();
  EXPECT_EQ(factorise(v, 0).kept, (std::vector<Index>{1, 2, 4}));
}

}  // namespace
}  // namespace couplet::coupling
