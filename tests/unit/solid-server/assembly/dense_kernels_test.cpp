#include "solid-server/assembly/dense_kernels.hpp"

#include <gtest/gtest.h>

namespace couplet::solid {
namespace {

TEST(DenseKernels, AreNamedForAProcessorThatTheLibraryDoesNotKnow) {
  EXPECT_EQ(better_kernels("Prescott", true, true), "SkylakeX");
  EXPECT_EQ(better_kernels("Prescott", true, false), "Haswell");
}

TEST(DenseKernels, AreLeftToTheLibraryWhereItKnowsTheProcessor) {
  EXPECT_EQ(better_kernels("Prescott", false, false), "");  // it may be a Pentium 4
  EXPECT_EQ(better_kernels("Zen", true, false), "");
  EXPECT_EQ(better_kernels("SkylakeX", true, true), "");
}

}  // namespace
}  // namespace couplet::solid
