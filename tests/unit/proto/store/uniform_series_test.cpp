#include "proto/store/uniform_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "proto/report/failure.hpp"

namespace couplet::store {
namespace {

TEST(UniformSeries, TakesEquallySpacedSamplesAsTheyAre) {
  std::vector<double> time, values;
  for (int k = 0; k <= 100; ++k) {
    time.push_back(0.01 * k);
    values.push_back(std::sin(0.3 * k));
  }
  const UniformSeries series = part_between(time, values, 0.5, 1.0);
  EXPECT_EQ(series.values.size(), 51);
  EXPECT_EQ(series.start, time[50]);
  EXPECT_NEAR(series.step, 0.01, 1e-15);
  EXPECT_EQ(series.values(50), values[100]);
}

TEST(UniformSeries, InterpolatesAnyCubicExactly) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> spacing(0.5, 1.5);
  const auto cubic = [](double t) { return 1 - 2 * t + 0.5 * t * t - 0.1 * t * t * t; };
  std::vector<double> time{0}, values{cubic(0)};
  for (int k = 0; k < 60; ++k) {
    time.push_back(time.back() + 0.05 * spacing(generator));
    values.push_back(cubic(time.back()));
  }
  const UniformSeries series = part_between(time, values, 0, time.back());
  ASSERT_GE(series.values.size(), 60);
  for (Eigen::Index k = 0; k < series.values.size(); ++k)
    EXPECT_NEAR(series.values(k), cubic(series.start + series.step * static_cast<double>(k)), 1e-13);  // values of 1
}

TEST(UniformSeries, RefusesAWindowWithoutEnoughRowsOrWithNotANumber) {
  std::vector<double> time(20), values(20, 1.0);
  for (int k = 0; k < 20; ++k) time[k] = k;
  EXPECT_THROW(part_between(time, values, 15, 19), report::NumericsError);
  EXPECT_NO_THROW(part_between(time, values, 10, 19));
  values[12] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(part_between(time, values, 10, 19), report::NumericsError);
}

}  // namespace
}  // namespace couplet::store
