#include "proto/report/progress.hpp"

#include <gtest/gtest.h>

namespace couplet::report {
namespace {

TEST(Progress, SaysEverythingThatIsKnown) {
  const ProgressState state{.step = 1200,
                            .time = 0.012,
                            .end_time = 0.6,
                            .iterations = 5,
                            .residual = 3.24e-6,
                            .steps_per_second = 812,
                            .simulated_per_second = 0.00812};
  EXPECT_EQ(progress_text(state),
            "step 1200  0.012 of 0.6 s (2%)  5 iterations  residual 3.2e-06  812 steps/s  0.0081 s/s  1 min 12 s left");
}

TEST(Progress, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(progress_text({.step = 1, .time = 1e-5, .end_time = 0.6, .iterations = 1}),
            "step 1  1e-05 of 0.6 s (0%)  1 iteration");
  EXPECT_EQ(progress_text({.step = 7, .time = 0.6, .end_time = 0.6}), "step 7  0.6 of 0.6 s (100%)");
}

TEST(Progress, TellsTimeLeftInUnitsOfPeople) {
  const auto left = [](double seconds) {
    const std::string text = progress_text({.step = 1, .time = 0, .end_time = seconds, .simulated_per_second = 1});
    return text.substr(text.find("s/s  ") + 5);
  };
  EXPECT_EQ(left(42), "42 s left");
  EXPECT_EQ(left(185), "3 min 5 s left");
  EXPECT_EQ(left(7800), "2 h 10 min left");
  EXPECT_EQ(left(5 * 86400), "5 days left");
}

TEST(Progress, PrintsNothingWhenQuietAndOneLineOfAShortRunWithoutTerminal) {
  for (const bool quiet : {true, false}) {
    testing::internal::CaptureStderr();  // not a terminal
    {
      Progress progress(0, 1, quiet);
      for (int step = 1; step <= 100; ++step) progress.step(step, 0.01 * step, 3, 1e-6);
      progress.finish();
    }
    const std::string printed = testing::internal::GetCapturedStderr();
    if (quiet) {
      EXPECT_EQ(printed, "");
    } else {
      EXPECT_TRUE(printed.starts_with("step 100  1 of 1 s (100%)  3 iterations")) << printed;
      EXPECT_EQ(printed.find('\n'), printed.size() - 1) << "one line";
      EXPECT_EQ(printed.find('\r'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace couplet::report
