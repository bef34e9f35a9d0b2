#include "proto/store/table_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <fstream>
#include <limits>
#include <random>

#include "proto/report/failure.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::store {
namespace {

const std::vector<Column> columns{{"time", "s"}, {"B1.x", "m"}, {"name", ""}};

TEST(TableFile, GivesBackTheSameBits) {
  const TemporaryFolder folder;
  std::mt19937_64 generator(1);
  std::vector<std::vector<double>> rows{{-0.0, 1e-320, 0.1},
                                        {std::numeric_limits<double>::infinity(), -1e308, 1.0 / 3},
                                        {std::numeric_limits<double>::max(), std::numeric_limits<double>::min(), -7}};
  while (rows.size() < 500) {
    std::vector<double> row(3);
    for (double& value : row) {
      do value = std::bit_cast<double>(generator());
      while (value != value);  // any bits but those of not-a-number
    }
    rows.push_back(row);
  }
  {
    TableWriter writer(folder / "t.csv", columns);
    for (const auto& row : rows) writer.append(row);
  }
  const Table table = read_table(folder / "t.csv");
  ASSERT_EQ(table.n_rows(), rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(table.values[column][row]),
                std::bit_cast<std::uint64_t>(rows[row][column]));
  }
}

TEST(TableFile, HasUnitsInBracketsInItsHeader) {
  const TemporaryFolder folder;
  TableWriter(folder / "t.csv", columns).append({0.001, -2, 0.1});
  EXPECT_EQ(text_of(folder / "t.csv"), "time [s],B1.x [m],name\n0.001,-2,0.1\n");
  const Table table = read_table(folder / "t.csv");
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[1].name, "B1.x");
  EXPECT_EQ(table.columns[1].unit, "m");
  EXPECT_EQ(table.columns[2].unit, "");
  EXPECT_EQ(table.find("name"), 2U);
}

TEST(TableFile, ShowsARowToOthersAtOnce) {
  const TemporaryFolder folder;
  TableWriter writer(folder / "t.csv", columns);
  EXPECT_EQ(read_table(folder / "t.csv").n_rows(), 0U);
  writer.append({1, 2, 3});
  EXPECT_EQ(read_table(folder / "t.csv").n_rows(), 1U);
}

TEST(TableFile, KeepsNotANumber) {
  const TemporaryFolder folder;
  TableWriter(folder / "t.csv", columns).append({1, std::numeric_limits<double>::quiet_NaN(), 3});
  EXPECT_TRUE(std::isnan(read_table(folder / "t.csv").values[1][0]));
}

TEST(TableFile, LeavesOutALastLineThatWasCutAnywhere) {
  const TemporaryFolder folder;
  const std::string whole = "time [s],x [m]\n0.5,1.25\n1.5,2.25";  // the line's end did not reach the disk
  for (std::size_t length = std::string("time [s],x [m]\n0.5,1.25\n").size(); length <= whole.size(); ++length) {
    std::ofstream(folder / "t.csv") << whole.substr(0, length);
    const Table table = read_table(folder / "t.csv");
    ASSERT_EQ(table.n_rows(), 1U) << length;
    EXPECT_EQ(table.values[1][0], 1.25);
  }
}

TEST(TableFile, NamesALineThatIsNoRow) {
  const TemporaryFolder folder;
  for (const std::string bad : {"1,2,3", "1", "1,x", "1,2 ", ""}) {
    std::ofstream(folder / "t.csv") << "time [s],x [m]\n0.5,1.25\n" << bad << "\n1.5,2.25\n";
    try {
      read_table(folder / "t.csv");
      FAIL() << bad << " was read";
    } catch (const report::FileError& error) {
      EXPECT_EQ(error.where(), (folder / "t.csv").string() + ":3");
      EXPECT_EQ(error.sentence(), "this line does not hold 2 numbers");
    }
  }
}

TEST(TableFile, NamesAMissingFile) {
  const TemporaryFolder folder;
  try {
    read_table(folder / "t.csv");
    FAIL() << "was read";
  } catch (const report::FileError& error) {
    EXPECT_EQ(error.where(), (folder / "t.csv").string());
    EXPECT_THAT(error.sentence(), testing::EndsWith("No such file or directory"));
  }
}

TEST(TableFile, ListsTheColumnsWhenOneIsMissing) {
  const Table table{columns, {{}, {}, {}}};
  try {
    table.find("B1.y");
    FAIL() << "was found";
  } catch (const report::SceneError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no column 'B1.y'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("time, B1.x, name"));
  }
}

TEST(TableFile, ContinuesAfterEarlierRowsByteByByte) {
  const TemporaryFolder folder;
  const auto row = [](int step) { return std::vector<double>{0.1 * step, 1.0 / (step + 1), -1e-9 * step}; };
  {
    TableWriter writer(folder / "whole.csv", columns);
    for (int step = 1; step <= 10; ++step) writer.append(row(step));
  }
  {
    TableWriter writer(folder / "resumed.csv", columns);
    for (int step = 1; step <= 7; ++step) writer.append(row(step));
  }
  {
    // A checkpoint of step 5: what came later is written again.
    const Table kept = rows_up_to(read_table(folder / "resumed.csv"), "time", 0.1 * 5);
    ASSERT_EQ(kept.n_rows(), 5U);
    TableWriter writer(folder / "resumed.csv", columns, kept);
    for (int step = 6; step <= 10; ++step) writer.append(row(step));
  }
  EXPECT_EQ(text_of(folder / "resumed.csv"), text_of(folder / "whole.csv"));
}

TEST(TableFile, SaysWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  const auto fill = [&] {
    TableWriter writer(folder / "t.csv", columns);
    limit_file_size(1000);
    try {
      for (int row = 0; row < 1000; ++row) writer.append({1.0 * row, 2, 3});
    } catch (const report::FileError& error) {
      std::exit(error.where() == (folder / "t.csv").string() ? 7 : 8);
    }
    std::exit(9);
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(7), "");
  EXPECT_GT(read_table(folder / "t.csv").n_rows(), 50U) << "what was written before stays readable";
}

}  // namespace
}  // namespace couplet::store
