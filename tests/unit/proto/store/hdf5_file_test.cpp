#include "proto/store/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "proto/report/failure.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::store {
namespace {

using surface::NodeArray;

std::string failure_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const report::FileError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(Hdf5File, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const NodeArray values = NodeArray::Random(7, 3);
  const std::vector<std::int64_t> integers{1, -2, std::int64_t{1} << 60};
  auto file = Hdf5File::create(folder / "a.h5");
  file.write("state/displacement", values);
  file.write_float("state/single", values);
  file.write("integers", integers);
  file.write("list", std::vector<double>{1, 2.5});
  file.write("state/none", NodeArray(0, 3));
  file.write("no_integers", std::vector<std::int64_t>{});
  file.write_number("time", 0.1);
  file.write_integer("step", -5);
  file.write_text("name", "Stimmlippe \xc3\xa4");
  file.write_text("empty", "");
  file.close();

  const auto read = Hdf5File::open_for_reading(folder / "a.h5");
  EXPECT_EQ(read.read("state/displacement"), values);
  EXPECT_EQ(read.read("state/single"), values.cast<float>().cast<double>());
  EXPECT_EQ(read.read_integers("integers"), integers);
  EXPECT_EQ(read.read("list"), (NodeArray(2, 1) << 1, 2.5).finished());
  EXPECT_EQ(read.read("state/none").rows(), 0);
  EXPECT_EQ(read.read("state/none").cols(), 3);
  EXPECT_TRUE(read.read_integers("no_integers").empty());
  EXPECT_EQ(read.read_number("time"), 0.1);
  EXPECT_EQ(read.read_integer("step"), -5);
  EXPECT_EQ(read.read_text("name"), "Stimmlippe \xc3\xa4");
  EXPECT_EQ(read.read_text("empty"), "");
  EXPECT_TRUE(read.contains("state/displacement"));
  EXPECT_FALSE(read.contains("state/velocity"));
  EXPECT_FALSE(read.contains("nowhere/at/all"));
}

TEST(Hdf5File, ReplacesAnArrayByOneOfAnotherShape) {
  const TemporaryFolder folder;
  Hdf5File::create(folder / "a.h5").write("x", NodeArray::Zero(7, 3));
  Hdf5File::open_for_appending(folder / "a.h5").write("x", NodeArray::Ones(2, 1));
  EXPECT_EQ(Hdf5File::open_for_reading(folder / "a.h5").read("x"), NodeArray::Ones(2, 1));
}

TEST(Hdf5File, WritesReservedPlacesWithoutTheLibrary) {
  const TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  const auto offset = file.reserve_double("later", 4);
  file.write("other", NodeArray::Ones(100, 3));
  EXPECT_EQ(file.offset_of("later"), offset);
  file.close();
  const double values[4]{1, 2, 3, 4};
  std::fstream raw(folder / "a.h5", std::ios::in | std::ios::out | std::ios::binary);
  raw.seekp(offset);
  raw.write(reinterpret_cast<const char*>(values), sizeof values);
  raw.close();
  const NodeArray read = Hdf5File::open_for_reading(folder / "a.h5").read("later");
  EXPECT_EQ(read, (NodeArray(4, 1) << 1, 2, 3, 4).finished());
}

TEST(Hdf5File, ShowsAnotherFileAsAGroupAlsoWhenBothAreMoved) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "first");
  auto file = Hdf5File::create(folder / "first" / "all.h5");
  file.link_to_file("state/one", "one.h5");
  file.close();
  EXPECT_FALSE(Hdf5File::open_for_reading(folder / "first" / "all.h5").contains("state/one/x"));
  Hdf5File::create(folder / "first" / "one.h5").write("x", NodeArray::Ones(2, 3));
  std::filesystem::rename(folder / "first", folder / "then");
  const auto read = Hdf5File::open_for_reading(folder / "then" / "all.h5");
  EXPECT_TRUE(read.contains("state/one/x"));
  EXPECT_EQ(read.read("state/one/x"), NodeArray::Ones(2, 3));
}

TEST(Hdf5File, NamesFileAndDatasetOfEveryFault) {
  const TemporaryFolder folder;
  const std::string path = (folder / "a.h5").string();
  auto file = Hdf5File::create(path);
  file.write("x", NodeArray::Zero(7, 3));
  file.write_text("text", "abc");
  file.write_integer("step", 1);
  EXPECT_EQ(failure_of([&] { file.read("y"); }), path + ": dataset 'y' is missing");
  EXPECT_EQ(failure_of([&] { file.read("no/such/group"); }), path + ": dataset 'no/such/group' is missing");
  EXPECT_EQ(failure_of([&] { file.read("text"); }), path + ": dataset 'text' does not hold real numbers");
  EXPECT_EQ(failure_of([&] { file.read_text("x"); }), path + ": dataset 'x' does not hold text");
  EXPECT_EQ(failure_of([&] { file.read_integers("x"); }), path + ": dataset 'x' does not hold whole numbers");
  EXPECT_EQ(failure_of([&] { file.read_number("x"); }), path + ": dataset 'x' is an array");
  EXPECT_EQ(failure_of([&] { file.read_number("step"); }), path + ": dataset 'step' does not hold a real number");
}

TEST(Hdf5File, NamesAFileThatIsMissingOrOfAnotherKind) {
  const TemporaryFolder folder;
  EXPECT_THAT(failure_of([&] { Hdf5File::open_for_reading(folder / "b.h5"); }),
              testing::AllOf(testing::StartsWith((folder / "b.h5").string() + ": cannot read this as an HDF5 file"),
                             testing::HasSubstr("No such file or directory")));
  std::ofstream(folder / "c.h5") << "time [s]\n";
  EXPECT_THAT(failure_of([&] { Hdf5File::open_for_reading(folder / "c.h5"); }),
              testing::StartsWith((folder / "c.h5").string() + ": cannot read this as an HDF5 file"));
  EXPECT_THAT(failure_of([&] { Hdf5File::create(folder / "none" / "d.h5"); }),
              testing::StartsWith((folder / "none" / "d.h5").string() + ": cannot make this file"));
}

TEST(Hdf5File, NoticesAFileThatWasCut) {
  const TemporaryFolder folder;
  Hdf5File::create(folder / "a.h5").write("x", NodeArray::Zero(1000, 3));
  std::filesystem::resize_file(folder / "a.h5", 5000);
  EXPECT_NE(failure_of([&] { Hdf5File::open_for_reading(folder / "a.h5").read("x"); }), "no failure");
}

TEST(Hdf5File, SaysWhenTheDiskIsFullAndEndsInOrder) {
  const TemporaryFolder folder;
  const auto fill = [&] {
    limit_file_size(100000);
    std::string failure;
    {
      auto file = Hdf5File::create(folder / "a.h5");
      failure = failure_of([&] {
        for (int k = 0; k < 10; ++k) file.write("x" + std::to_string(k), NodeArray::Ones(1000, 3));
        file.close();
      });
    }
    const bool is_told =
        failure.starts_with((folder / "a.h5").string()) && failure.find("File too large") != std::string::npos;
    std::fprintf(stderr, "%s\n", failure.c_str());
    std::exit(is_told ? 7 : 8);  // the library's own end of process must not spoil it
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(7), "");
}

TEST(Hdf5File, ServesSeveralThreads) {
  const TemporaryFolder folder;
  const auto work = [&](int number) {
    const std::string name = "thread" + std::to_string(number) + ".h5";
    for (int round = 0; round < 20; ++round) {
      auto file = Hdf5File::create(folder / name);
      file.write("a/b", NodeArray::Constant(100, 3, number));
      file.close();
      ASSERT_EQ(Hdf5File::open_for_reading(folder / name).read("a/b")(99, 2), number);
    }
  };
  std::thread first(work, 1), second(work, 2);
  first.join();
  second.join();
}

}  // namespace
}  // namespace couplet::store
