#include "proto/wire/failure_message.hpp"

#include <gtest/gtest.h>

#include <new>

#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

template <class Fault>
v1::Failure described(const Fault& fault) {
  return describe_failure(std::make_exception_ptr(fault));
}

template <class Fault>
void expect_the_same_after_the_journey(const Fault& fault) {
  try {
    throw_failure(described(fault), "solid");
  } catch (const Fault& back) {
    EXPECT_EQ(back.kind(), fault.kind());
    EXPECT_EQ(back.where(), fault.where());
    EXPECT_EQ(back.sentence(), fault.sentence());
    EXPECT_EQ(back.advice(), fault.advice());
    return;
  } catch (...) {
  }
  ADD_FAILURE() << "another type of exception than " << fault.what();
}

TEST(FailureMessage, EveryKindIsThrownAsTheSameType) {
  expect_the_same_after_the_journey(report::SceneError("solid.body[0]", "is missing", "add it"));
  expect_the_same_after_the_journey(report::NumericsError("element 12", "is inverted at t = 0.1 s", "halve the step"));
  expect_the_same_after_the_journey(report::PeerError("session", "wrong order", "see the table"));
  expect_the_same_after_the_journey(report::FileError("/tmp/x.h5", "cannot be written", "free some space"));
  expect_the_same_after_the_journey(report::Failure(report::FailureKind::bug, "here", "wrong", "tell us"));
}

TEST(FailureMessage, WithoutAPlaceTheProgramIsNamed) {
  try {
    throw_failure(described(report::NumericsError("", "diverged")), "solid");
  } catch (const report::NumericsError& back) {
    EXPECT_EQ(back.where(), "solid");
  }
}

TEST(FailureMessage, OtherExceptionsHaveAKindToo) {
  EXPECT_EQ(described(std::bad_alloc()).kind(), v1::Failure::NUMERICS);
  EXPECT_EQ(described(std::logic_error("index out of range")).kind(), v1::Failure::BUG);
  EXPECT_NE(described(std::logic_error("index out of range")).sentence().find("index out of range"), std::string::npos);
  EXPECT_EQ(described(42).kind(), v1::Failure::BUG);
}

TEST(FailureMessage, AnUnknownKindCountsAsABug) {
  v1::Failure failure;
  failure.set_sentence("something");
  try {
    throw_failure(failure, "solid");
  } catch (const report::Failure& back) {
    EXPECT_EQ(back.kind(), report::FailureKind::bug);
  }
}

}  // namespace

}  // namespace couplet::wire
