#include "proto/store/cycles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace couplet::store {
namespace {

using std::numbers::pi;

UniformSeries sampled(double duration, double step, const std::function<double(double)>& function) {
  UniformSeries series{0, step, Eigen::VectorXd(static_cast<Eigen::Index>(duration / step) + 1)};
  for (Eigen::Index k = 0; k < series.values.size(); ++k) series.values(k) = function(step * static_cast<double>(k));
  return series;
}

TEST(Cycles, HaveTheirDurationExtremesAndMean) {
  // 40 samples a cycle: (2 pi / 40)^2 / 8 = 0.3% is missed by the largest sample, a hundredth of that by the parabola.
  const auto series = sampled(10.4, 1.0 / 40, [](double t) { return 2 + 3 * std::sin(2 * pi * t + 0.4); });
  const auto cycles = cut_cycles(series, 1);
  ASSERT_EQ(cycles.size(), 9U);
  for (const Cycle& cycle : cycles) {
    EXPECT_NEAR(cycle.duration, 1, 1e-3);
    EXPECT_NEAR(cycle.largest, 5, 2e-4);
    EXPECT_NEAR(cycle.smallest, -1, 2e-4);
    EXPECT_NEAR(cycle.mean, 2, 5e-3);  // trapezoidal rule and the straight line to the crossing
  }
  EXPECT_NEAR(cycles[1].start, cycles[0].start + cycles[0].duration, 1e-12);
}

TEST(Cycles, AreNotCutByRipples) {
  const auto series =
      sampled(20, 0.005, [](double t) { return std::sin(2 * pi * t) + 0.4 * std::sin(2 * pi * 9 * t + 1); });
  const auto cycles = cut_cycles(series, 1);
  ASSERT_GE(cycles.size(), 18U);
  for (const Cycle& cycle : cycles) EXPECT_NEAR(cycle.duration, 1, 0.15);
}

TEST(Cycles, AreOnlyWholeOnes) {
  EXPECT_EQ(cut_cycles(sampled(1.5, 0.01, [](double t) { return std::cos(2 * pi * t); }), 1).size(), 0U);
  EXPECT_EQ(cut_cycles(sampled(2.5, 0.01, [](double t) { return std::cos(2 * pi * t); }), 1).size(), 1U);
}

}  // namespace
}  // namespace couplet::store
