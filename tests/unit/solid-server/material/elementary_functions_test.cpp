// Powers and exponentials of eight numbers at once against those of the standard library.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "solid-server/material/exponential.hpp"
#include "solid-server/material/inverse_cube_root.hpp"
#include "solid-server/material/inverse_square_root.hpp"

namespace couplet::solid {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(InverseCubeRoot, IsExactToRoundOffForAnyPositiveNumber) {
  for (double x = 1e-6; x < 1e6; x *= 1.01) {
    Pack packed{};
    for (int lane = 0; lane < n_lanes; ++lane) packed[lane] = x * (1 + 1e-3 * lane);
    const Pack root = inverse_cube_root(packed);
    for (int lane = 0; lane < n_lanes; ++lane)
      EXPECT_NEAR(root[lane] * std::cbrt(packed[lane]), 1, 1e-15) << packed[lane];
  }
}

TEST(InverseSquareRoot, IsExactToRoundOffForAnyPositiveNumber) {
  for (double x = 1e-307; x < 1e307; x *= 1.037) {
    Pack packed{};
    for (int lane = 0; lane < n_lanes; ++lane) packed[lane] = x * (1 + 3e-3 * lane);
    const Pack root = inverse_square_root(packed);
    for (int lane = 0; lane < n_lanes; ++lane)
      EXPECT_NEAR(root[lane] * std::sqrt(packed[lane]), 1, 1e-15) << packed[lane];
  }
}

TEST(InverseSquareRoot, LeavesTheRootOfZeroZero) {
  const Pack zero{};
  EXPECT_EQ((zero * inverse_square_root(zero))[0], 0);  // the stretch of a fibre without length
}

TEST(Exponential, IsExactToRoundOffOverTheWholeRange) {
  for (double x = -708; x < 709.7; x += 0.0917) {
    Pack packed{};
    for (int lane = 0; lane < n_lanes; ++lane) packed[lane] = x * (1 - 1e-3 * lane);
    const Pack result = exponential(packed);
    for (int lane = 0; lane < n_lanes; ++lane) {
      const long double truth = std::exp(static_cast<long double>(packed[lane]));
      EXPECT_NEAR(static_cast<double>(result[lane] / truth), 1, 1e-15) << packed[lane];
    }
  }
}

TEST(Exponential, IsExactToRoundOffNextToZero) {
  for (double x = 1e-300; x < 1; x *= 3) {
    const Pack result = exponential(Pack{x, -x});
    EXPECT_NEAR(result[0], std::exp(x), 1e-15 * std::exp(x)) << x;
    EXPECT_NEAR(result[1], std::exp(-x), 1e-15) << x;
  }
  EXPECT_EQ(exponential(Pack{})[0], 1);
}

TEST(Exponential, GoesToInfinityAndToZeroAsTheStandardLibraryDoes) {
  const Pack x{709.78, 709.79, 1e4, infinity, -740, -746, -1e300, -infinity};
  const Pack result = exponential(x);
  for (int lane = 0; lane < n_lanes; ++lane) {
    if (lane == 4)  // one of the numbers with few digits: to its last one
      EXPECT_NEAR(result[lane], std::exp(x[lane]), std::numeric_limits<double>::denorm_min());
    else if (lane == 0)
      EXPECT_NEAR(result[lane] / std::exp(x[lane]), 1, 1e-15);
    else
      EXPECT_EQ(result[lane], std::exp(x[lane])) << x[lane];
  }
  EXPECT_TRUE(std::isnan(exponential(Pack{} + std::numeric_limits<double>::quiet_NaN())[0]));
}

}  // namespace
}  // namespace couplet::solid
