#include "flow-server/output/velocity_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/flow-server/state_from_formula.hpp"

namespace couplet::flow {
namespace {

constexpr double round_off = 1e-12;  // some hundred operations on numbers of order one

TEST(VelocityGradient, IsExactForLinearFieldsOnAnyCells) {
  const Tensor3 a{{{0.3, -1.1, 0.7}, {0.2, 0.4, 2.0}, {-0.9, 0.5, -0.7}}};
  std::array<Formula, 3> velocity;
  for (std::size_t c = 0; c < 3; ++c)
    velocity[c] = [&a, c](const Point& x) { return a[c][0] * x[0] + a[c][1] * x[1] + a[c][2] * x[2] + 0.1; };
  const FormulaFlow flow(stretched_box({12, 10, 8}), velocity, [](const Point&) { return 0.0; });
  const CellVelocity reader(flow.grid, flow.decomposition.mine().begin, flow.state);
  const Triple sizes = flow.decomposition.mine().sizes();
  for (int k = 0; k < sizes[2]; ++k)
    for (int j = 0; j < sizes[1]; ++j)
      for (int i = 0; i < sizes[0]; ++i) {
        const Tensor3 gradient = reader.gradient({i, j, k});
        const Vector3 u = reader.at({i, j, k});
        const Point centre = flow.place(i, j, k, -1);
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(u[c], velocity[c](centre), round_off);
          for (std::size_t d = 0; d < 3; ++d)
            EXPECT_NEAR(gradient[c][d], a[c][d], round_off * 100);  // over widths of 1/30
        }
      }
}

TEST(VelocityGradient, HasTheSignsOfARotation) {
  const double rate = 3;  // about z
  const Tensor3 rotation{{{0, -rate, 0}, {rate, 0, 0}, {0, 0, 0}}};
  EXPECT_EQ(vorticity(rotation), (Vector3{0, 0, 2 * rate}));
  EXPECT_NEAR(q_criterion(rotation), rate * rate, round_off);
  EXPECT_NEAR(swirling_strength(rotation), rate, round_off);
}

TEST(VelocityGradient, FindsNoVortexInStrainAndShear) {
  EXPECT_EQ(swirling_strength({{{1, 0, 0}, {0, -1, 0}, {0, 0, 0}}}), 0);
  EXPECT_EQ(swirling_strength({{{0, 5, 0}, {0, 0, 0}, {0, 0, 0}}}), 0);
  EXPECT_LT(q_criterion({{{1, 0, 0}, {0, -1, 0}, {0, 0, 0}}}), 0);
  EXPECT_EQ(swirling_strength({}), 0);
}

TEST(VelocityGradient, FindsTheComplexPairOfAStretchedVortex) {
  // Block of eigenvalues -1/2 +- 2i beside 1, seen from a turned frame, in which it looks like any gradient.
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Tensor3 vortex{{{-0.5, -2, 0}, {2, -0.5, 0}, {0, 0, 1}}};
  const Tensor3 turn{{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
  Tensor3 turned{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l) turned[i][j] += turn[i][k] * vortex[k][l] * turn[j][l];
  EXPECT_NEAR(swirling_strength(turned), 2, round_off);
}

}  // namespace
}  // namespace couplet::flow
