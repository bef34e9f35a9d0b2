#include "proto/store/checkpoint_schedule.hpp"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

namespace couplet::store {
namespace {

using std::chrono::seconds;
const CheckpointSchedule::Clock::time_point start{seconds(1000)};

CheckpointSchedule schedule(const std::string& output, std::int64_t first_step = 0) {
  v1::Output message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(output, &message));
  return {message, first_step, start};
}

TEST(CheckpointSchedule, WritesNoneUnlessTheSceneNamesThem) {
  const auto none = schedule("");
  EXPECT_FALSE(none.is_due(10, start + seconds(100'000)));
  EXPECT_FALSE(none.is_missing(10));
}

TEST(CheckpointSchedule, CountsSteps) {
  auto every_five = schedule("checkpoints { every_steps: 5 }", 5);
  EXPECT_FALSE(every_five.is_due(5, start)) << "the run was resumed there";
  EXPECT_FALSE(every_five.is_due(6, start + seconds(100'000))) << "only steps count";
  EXPECT_TRUE(every_five.is_missing(6));
  EXPECT_TRUE(every_five.is_due(10, start));
  every_five.note_written(10, start, start);
  EXPECT_FALSE(every_five.is_due(10, start));
  EXPECT_FALSE(every_five.is_missing(10));
}

TEST(CheckpointSchedule, CountsMinutesFiveUnlessSaidOtherwise) {
  auto by_default = schedule("checkpoints { }");
  EXPECT_FALSE(by_default.is_due(1, start + seconds(299)));
  EXPECT_TRUE(by_default.is_due(1, start + seconds(300)));
  by_default.note_written(1, start + seconds(300), start + seconds(301));
  EXPECT_FALSE(by_default.is_due(2, start + seconds(600)));
  EXPECT_TRUE(by_default.is_due(2, start + seconds(601)));
  EXPECT_TRUE(schedule("checkpoints { every_minutes: 0.5 }").is_due(1, start + seconds(30)));
}

TEST(CheckpointSchedule, TakesWhicheverComesFirst) {
  const auto both = schedule("checkpoints { every_steps: 5 every_minutes: 1 }");
  EXPECT_TRUE(both.is_due(5, start));
  EXPECT_TRUE(both.is_due(1, start + seconds(60)));
  EXPECT_FALSE(both.is_due(1, start + seconds(59)));
}

TEST(CheckpointSchedule, NeverTakesMoreThanAFiftiethOfTheRun) {
  auto slow_disk = schedule("checkpoints { every_minutes: 1 }");
  slow_disk.note_written(1, start, start + seconds(20));
  EXPECT_FALSE(slow_disk.is_due(2, start + seconds(20 + 999)));
  EXPECT_TRUE(slow_disk.is_due(2, start + seconds(20 + 1000)));
  EXPECT_EQ(slow_disk.n_written(), 1);
  EXPECT_EQ(slow_disk.seconds(), 20);
}

}  // namespace
}  // namespace couplet::store
