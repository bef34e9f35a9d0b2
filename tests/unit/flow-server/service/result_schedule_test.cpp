#include "flow-server/service/result_schedule.hpp"

#include <gtest/gtest.h>

namespace couplet::flow {
namespace {

TEST(ResultSchedule, IsOffUnlessTheSceneAsksForResults) {
  EXPECT_FALSE(ResultSchedule{}.is_due(0, 1e9));
}

TEST(ResultSchedule, EveryTimeIsMetOnceThoughStepsAddUpWithRoundOff) {
  const ResultSchedule schedule{0.1, 1e-3};
  double t = 0;
  int n_due = 0;
  for (int step = 0; step < 30000; ++step) {
    const double before = t;
    t += 1e-5;
    n_due += schedule.is_due(before, t) ? 1 : 0;
  }
  EXPECT_EQ(n_due, 201);  // 0.1, 0.101, ..., 0.3
}

TEST(ResultSchedule, AStepOverSeveralTimesIsStoredOnce) {
  const ResultSchedule schedule{0, 1e-3};
  EXPECT_TRUE(schedule.is_due(0.5e-3, 3.5e-3));
  EXPECT_FALSE(schedule.is_due(3.5e-3, 3.9e-3));
}

}  // namespace
}  // namespace couplet::flow
