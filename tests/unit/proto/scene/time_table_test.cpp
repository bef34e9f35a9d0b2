#include "proto/scene/time_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/scene/make_time_table.hpp"

namespace couplet::scene {
namespace {

TEST(TimeTable, IsHeldBeforeTheFirstRowAndAfterTheLast) {
  const TimeTable table{{1, 2}, {10, 20}, false};
  EXPECT_EQ(table.at(-5), 10);
  EXPECT_EQ(table.at(1), 10);
  EXPECT_EQ(table.at(2), 20);
  EXPECT_EQ(table.at(99), 20);
}

TEST(TimeTable, IsStraightBetweenRows) {
  const TimeTable table{{0, 1, 3}, {0, 4, 0}, false};
  EXPECT_DOUBLE_EQ(table.at(0.25), 1);
  EXPECT_DOUBLE_EQ(table.at(2), 2);
}

TEST(TimeTable, HasTheRateOfItsSlope) {
  const TimeTable line{{0, 1, 3}, {0, 4, 0}, false};
  EXPECT_EQ(line.rate(0), 0);  // held before
  EXPECT_EQ(line.rate(0.5), 4);
  EXPECT_EQ(line.rate(1), 4);  // of the part that ends there
  EXPECT_EQ(line.rate(2), -2);
  EXPECT_EQ(line.rate(3), -2);
  EXPECT_EQ(line.rate(3.5), 0);
  const TimeTable smooth{{0, 2}, {0, 3}, true};
  EXPECT_DOUBLE_EQ(smooth.rate(1), 1.5 * 3.14159265358979323846 / 2);  // steepest half-way: pi / 2 of the mean slope
  EXPECT_NEAR(smooth.rate(2), 0, 1e-15);
}

TEST(TimeTable, IsSmoothWithACosine) {
  const TimeTable table{{0, 1}, {0, 2}, true};
  EXPECT_DOUBLE_EQ(table.at(0.5), 1);
  EXPECT_NEAR(table.at(0.25), 1 - std::sqrt(0.5), 1e-15);  // round-off
  const double step = 1e-4;
  // The slope at a row vanishes as pi^2/2 step: 5e-4 here.
  EXPECT_LT((table.at(step) - table.at(0)) / step, 1e-3);
  EXPECT_LT((table.at(1) - table.at(1 - step)) / step, 1e-3);
}

TEST(TimeTable, OfOneRowIsConstant) {
  const TimeTable table{{0}, {7}, true};
  EXPECT_EQ(table.at(-1), 7);
  EXPECT_EQ(table.at(1), 7);
}

TEST(TimeTable, IsMadeFromTheScene) {
  v1::TimeTable message;
  for (const double time : {0.0, 0.5}) {
    message.add_row()->set_time(time);
    message.mutable_row(message.row_size() - 1)->set_value(10 * time);
  }
  EXPECT_FALSE(make_time_table(message).cosine);
  message.set_interpolation(v1::TimeTable::COSINE);
  const TimeTable table = make_time_table(message);
  EXPECT_EQ(table.time, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(table.value, (std::vector<double>{0, 5}));
  EXPECT_TRUE(table.cosine);
}

}  // namespace
}  // namespace couplet::scene
