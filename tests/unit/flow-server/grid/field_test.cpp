#include "flow-server/grid/field.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace couplet::flow {
namespace {

TEST(Field, IsZeroInTheBeginningGhostsIncluded) {
  const Field<double> field({4, 3, 2}, {2, 2, 2});
  EXPECT_EQ(field.n_values(), 8u * 7u * 6u);
  for (std::size_t i = 0; i < field.n_values(); ++i) EXPECT_EQ(field.data()[i], 0);
}

TEST(Field, KeepsEveryEntryApart) {
  Field<float> field({4, 3, 1}, {2, 1, 0});
  float count = 0;
  for (int j = -1; j < 4; ++j)
    for (int i = -2; i < 6; ++i) field(i, j, 0) = ++count;
  EXPECT_EQ(count, static_cast<float>(field.n_values()));
  EXPECT_EQ(field(-2, -1, 0), 1);
  EXPECT_EQ(field.data()[0], 1);
  EXPECT_EQ(field(5, 3, 0), count);
  EXPECT_EQ(field.row(2, 0)[1], field(1, 2, 0));
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * 4096;
}

TEST(Field, TakesNoMemoryForPartsThatAreNeverWritten) {
  const double before = resident_bytes();
  Field<double> field({512, 256, 256}, {2, 2, 2});
  for (int k = 0; k < 8; ++k) field.row(10, k)[5] = 1;
  EXPECT_EQ(field(5, 10, 7), 1);
  // 270 MB are allocated; eight rows touch eight pages of 4 kB. One per cent leaves room for what else the process
  // does.
  EXPECT_LT(resident_bytes() - before, 0.01 * static_cast<double>(field.n_values() * sizeof(double)));
  EXPECT_LE(field.n_bytes(), 9u * 4096u);  // with the page that was read
}

}  // namespace
}  // namespace couplet::flow
