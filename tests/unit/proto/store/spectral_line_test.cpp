#include "proto/store/spectral_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "proto/report/failure.hpp"

namespace couplet::store {
namespace {

using std::numbers::pi;

UniformSeries sampled_line(double duration, double step, const std::function<double(double)>& function) {
  UniformSeries series{0.3, step, Eigen::VectorXd(static_cast<Eigen::Index>(duration / step) + 1)};
  for (Eigen::Index k = 0; k < series.values.size(); ++k) series.values(k) = function(step * static_cast<double>(k));
  return series;
}

TEST(SpectralLine, FindsFrequencyAmplitudeAndPhaseOfACosine) {
  // Any part of a period at the end, any phase: 20 cycles are enough for 0.01% of frequency, 0.1% of amplitude, 0.2
  // degrees.
  for (const double cycles : {20.0, 20.3, 20.5, 23.7}) {
    for (const double phase : {0.0, 1.1, -2.9, 2.4}) {
      const auto series =
          sampled_line(cycles / 137.0, 1e-5, [&](double t) { return 5 + 0.8 * std::cos(2 * pi * 137 * t + phase); });
      const SpectralLine line = find_main_line(series, 20, 1000);
      EXPECT_NEAR(line.frequency, 137, 1e-4 * 137);
      EXPECT_NEAR(line.amplitude, 0.8, 1e-3 * 0.8);
      EXPECT_NEAR(line.phase, phase, 0.2 * pi / 180 + 2 * pi * 20 * 1e-4 / 2);  // a wrong frequency turns the start
    }
  }
}

TEST(SpectralLine, FindsTheStrongerOfTwoLinesUnlessItIsOutsideTheLimits) {
  const auto series = sampled_line(
      0.3, 2e-5, [](double t) { return std::cos(2 * pi * 140 * t) + 1.5 * std::sin(2 * pi * 310 * t) + 4 * t; });
  EXPECT_NEAR(find_main_line(series, 20, 1000).frequency, 310, 0.0005 * 310);
  EXPECT_NEAR(find_main_line(series, 20, 200).frequency, 140, 0.0005 * 140);
}

TEST(SpectralLine, StandsNoise) {
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0, 0.3);
  const auto series =
      sampled_line(20 / 140.0, 1e-5, [&](double t) { return std::cos(2 * pi * 140 * t + 0.5) + noise(generator); });
  const SpectralLine line = find_main_line(series, 20, 1000);
  // Cramer-Rao bound for 14,000 samples: about 0.05% of frequency for this window; three times that is taken.
  EXPECT_NEAR(line.frequency, 140, 0.0015 * 140);
  EXPECT_NEAR(line.amplitude, 1, 0.02);
}

TEST(SpectralLine, RefusesAColumnWithoutOne) {
  const auto message = [](const UniformSeries& series, double from, double to) -> std::string {
    try {
      find_main_line(series, from, to);
    } catch (const report::NumericsError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(sampled_line(0.1, 1e-4, [](double) { return 3.0; }), 20, 1000),
              testing::HasSubstr("does not change"));
  EXPECT_THAT(message(sampled_line(0.1, 1e-4, [](double t) { return std::exp(-3 * t); }), 300, 301),
              testing::HasSubstr("no spectral line between 300 Hz and 301 Hz"));
  EXPECT_THAT(message(sampled_line(2.5 / 140, 1e-5, [](double t) { return std::cos(2 * pi * 140 * t); }), 20, 1000),
              testing::HasSubstr("fewer than 3 cycles"));
}

}  // namespace
}  // namespace couplet::store
