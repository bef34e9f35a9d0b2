#include "proto/report/failure.hpp"

#include <gtest/gtest.h>

#include <new>

namespace couplet::report {
namespace {

TEST(Failure, IsOneLineOfWhereWhatAndWhatToDo) {
  EXPECT_STREQ(FileError("a.h5", "is cut", "make it again").what(), "a.h5: is cut; make it again");
  EXPECT_STREQ(NumericsError("", "diverged").what(), "diverged");
  EXPECT_STREQ(PeerError("flow", "is lost").what(), "flow: is lost");
}

TEST(Failure, EachKindHasItsExitCode) {
  EXPECT_EQ(exit_code(SceneError("", "").kind()), 2);
  EXPECT_EQ(exit_code(NumericsError("", "").kind()), 3);
  EXPECT_EQ(exit_code(PeerError("", "").kind()), 4);
  EXPECT_EQ(exit_code(FileError("", "").kind()), 5);
  EXPECT_EQ(exit_code(FailureKind::bug), 70);
}

TEST(RunProgram, TurnsWhateverIsThrownIntoOneLineAndAnExitCode) {
  const auto outcome = [](int (*body)(int, char**)) {
    testing::internal::CaptureStderr();
    const int code = run_program("coupler", body, 0, nullptr);
    return std::to_string(code) + " " + testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(outcome([](int, char**) { return 0; }), "0 ");
  EXPECT_EQ(outcome([](int, char**) -> int { throw PeerError("flow", "is lost", "look at its log"); }),
            "4 coupler: flow: is lost; look at its log\n");
  EXPECT_EQ(outcome([](int, char**) -> int { throw std::bad_alloc(); }),
            "3 coupler: out of memory; use a coarser mesh or fewer stored states\n");
  EXPECT_EQ(outcome([](int, char**) -> int { throw std::logic_error("empty"); }),
            "70 coupler: this is a bug in Couplet: empty; please report it with the scene\n");
}

}  // namespace
}  // namespace couplet::report
