// Started on 1 rank.
#include "flow-server/poisson/pressure_operator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::flow {
namespace {

struct StretchedBox {
  StretchedGrid grid{{StretchedAxis(symmetrically_stretched_faces(0, 1, 12, 5), false),
                      StretchedAxis(symmetrically_stretched_faces(0, 1, 10, 2), true),
                      StretchedAxis(symmetrically_stretched_faces(0, 1, 9, 8), false)},
                     3};
  BlockDecomposition blocks{
      MPI_COMM_SELF, {Partition{{0, 12}}, Partition{{0, 10}}, Partition{{0, 9}}}, {false, true, false}};
  PressureProblem problem;
  StretchedBox() {
    problem.grid = &grid, problem.decomposition = &blocks;
    problem.border_is_open[0] = {true, false};
  }
  template <class Number>
  Field<Number> field(int ghosts, double seed) const {
    Field<Number> values({12, 10, 9}, {ghosts, ghosts, ghosts});
    for (int k = 0; k < 9; ++k)
      for (int j = 0; j < 10; ++j)
        for (int i = 0; i < 12; ++i) values(i, j, k) = static_cast<Number>(std::sin(seed * (i + 13 * j + 177 * k)));
    if (ghosts > 0)
      for (int k = 0; k < 9; ++k)
        for (int i = 0; i < 12; ++i) values(i, -1, k) = values(i, 9, k), values(i, 10, k) = values(i, 0, k);
    return values;
  }
};

TEST(PressureOperator, IsSymmetricInTheVolumeWeightedProduct) {
  const StretchedBox box;
  const PressureOperator div_grad(box.problem);
  const Field<float> a = box.field<float>(1, 0.7), b = box.field<float>(1, 1.3);
  const Field<double> nothing = box.field<double>(0, 0);
  const double ab = div_grad.direction_sums(a, nothing, b).correction_conjugate;
  const double ba = div_grad.direction_sums(b, nothing, a).correction_conjugate;
  EXPECT_NEAR(ab, ba, 1e-12 * std::abs(ab));  // round-off of 1080 terms
  EXPECT_LT(div_grad.direction_sums(a, nothing, b).correction_operator, 0);
}

TEST(PressureOperator, AdvancesTheResidualWithTheSolution) {
  const StretchedBox box;
  const PressureOperator div_grad(box.problem);
  const Field<double> source = box.field<double>(0, 0.4);
  Field<double> phi = box.field<double>(1, 0.9), residual({12, 10, 9}, {0, 0, 0}), again({12, 10, 9}, {0, 0, 0});
  Field<float> p = box.field<float>(1, 0.2), rhs({12, 10, 9}, {4, 4, 4});
  div_grad.residual(source, 0.1, phi, &residual);
  const double squares = div_grad.advance(box.field<float>(1, 1.9), 0.3, -0.7, p, phi, residual, rhs);
  for (int k = 0; k < 9; ++k)
    for (int i = 0; i < 12; ++i) phi(i, -1, k) = phi(i, 9, k), phi(i, 10, k) = phi(i, 0, k);
  const double expected = div_grad.residual(source, 0.1, phi, &again);
  EXPECT_NEAR(squares, expected, 1e-11 * expected);  // round-off of sums with widths from 0.02 to 0.2
  for (int i = 0; i < 12; ++i) {
    EXPECT_NEAR(residual(i, 4, 5), again(i, 4, 5), 1e-10 * std::sqrt(expected));
    EXPECT_EQ(rhs(i, 4, 5), static_cast<float>(residual(i, 4, 5)));
  }
}

TEST(PressureOperator, MomentsAreIntegrals) {
  const StretchedBox box;
  const PressureOperator div_grad(box.problem);
  Field<double> three({12, 10, 9}, {0, 0, 0});
  div_grad.subtract_to(three, -3, three);
  EXPECT_NEAR(div_grad.volume(), 1, 1e-14);
  EXPECT_NEAR(div_grad.moments(three)[0], 3, 1e-13);
  EXPECT_NEAR(div_grad.moments(three)[1], 9, 1e-13);
  EXPECT_TRUE(div_grad.has_open_border());
}

}  // namespace
}  // namespace couplet::flow
