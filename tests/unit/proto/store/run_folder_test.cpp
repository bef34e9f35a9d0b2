#include "proto/store/run_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::store {
namespace {

TEST(RunFolder, IsMadeWithAPlaceForResults) {
  const TemporaryFolder folder;
  const RunFolder run = make_run_folder(folder / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(run.results()));
  EXPECT_EQ(run.history().filename(), "history.csv");
  EXPECT_NO_THROW(make_run_folder(folder / "a" / "b")) << "one that is there already is taken";
}

TEST(RunFolder, SaysWhyItCannotBeMade) {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  try {
    make_run_folder(folder / "file" / "run");
    FAIL() << "was made";
  } catch (const report::FileError& error) {
    EXPECT_EQ(error.where(), (folder / "file" / "run").string());
    EXPECT_EQ(error.sentence(), "cannot make this folder: Not a directory");
  }
}

TEST(WriteFile, ReplacesTheWholeText) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "a long first text");
  write_file(folder / "a.txt", "short");
  EXPECT_EQ(text_of(folder / "a.txt"), "short");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt.part"));
}

TEST(WriteFile, LeavesTheOldTextWhenTheDiskIsFull) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "old");
  const auto attempt = [&] {
    limit_file_size(1000);
    try {
      write_file(folder / "a.txt", std::string(5000, 'x'));
    } catch (const report::FileError& error) {
      std::exit(error.where() == (folder / "a.txt").string() ? 7 : 8);
    }
    std::exit(9);
  };
  EXPECT_EXIT(attempt(), testing::ExitedWithCode(7), "");
  EXPECT_EQ(text_of(folder / "a.txt"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.txt.part"));
}

TEST(WriteFile, NamesAFolderThatIsMissing) {
  const TemporaryFolder folder;
  try {
    write_file(folder / "missing" / "a.txt", "text");
    FAIL() << "was written";
  } catch (const report::FileError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("a.txt: cannot write: No such file or directory"));
  }
}

}  // namespace
}  // namespace couplet::store
