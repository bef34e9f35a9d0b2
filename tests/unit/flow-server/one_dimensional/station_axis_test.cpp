#include "flow-server/one_dimensional/station_axis.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace couplet::flow {
namespace {

class StationAxisOf : public ::testing::TestWithParam<int> {};

TEST_P(StationAxisOf, RisesFromInletToExitAndIsDenserAtTheExit) {
  const StationAxis axis(GetParam());
  const auto& xi = axis.fraction();
  EXPECT_EQ(xi[0], 0);
  EXPECT_EQ(xi[axis.n_stations() - 1], 1);
  for (int k = 1; k < axis.n_stations(); ++k) EXPECT_GT(xi[k], xi[k - 1]);
  EXPECT_LT(xi[axis.n_stations() - 1] - xi[axis.n_stations() - 2], xi[1] - xi[0]);
}

TEST_P(StationAxisOf, FindsTheStationThatLinearSearchFinds) {
  const StationAxis axis(GetParam());
  const auto& xi = axis.fraction();
  const auto by_search = [&](double place) {
    int k = 0;
    while (k < axis.n_stations() && xi[k] < place) ++k;
    return k;
  };
  for (int i = -10; i <= 1010; ++i) EXPECT_EQ(axis.first_at_or_after(i * 1e-3), by_search(i * 1e-3)) << i;
  for (int k = 0; k < axis.n_stations(); ++k) {
    EXPECT_EQ(axis.first_at_or_after(xi[k]), k);
    EXPECT_EQ(axis.first_at_or_after(std::nextafter(xi[k], 2.0)), k + 1);
  }
}

// The last one has stations closer together than the bins of the lookup.
INSTANTIATE_TEST_SUITE_P(Stations, StationAxisOf, ::testing::Values(3, 20, 140, 5000));

TEST(StationAxis, TakesAnythingForAPlaceWithoutLeavingItsTable) {
  const StationAxis axis(140);
  EXPECT_EQ(axis.first_at_or_after(-std::numeric_limits<double>::infinity()), 0);
  EXPECT_EQ(axis.first_at_or_after(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(axis.first_at_or_after(std::numeric_limits<double>::infinity()), 140);
}

}  // namespace
}  // namespace couplet::flow
