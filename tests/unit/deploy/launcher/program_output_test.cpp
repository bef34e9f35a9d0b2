// Lines, updates and speakers in what programs say.

#include <gmock/gmock.h>

#include "deploy/launcher/child_process.hpp"
#include "deploy/launcher/mpi_output.hpp"

namespace couplet::launcher {
namespace {

std::vector<OutputLine> split(const std::vector<std::string>& pieces) {
  OutputSplitter splitter;
  std::vector<OutputLine> lines;
  for (const std::string& piece : pieces) {
    for (const OutputLine& line : splitter.add(piece.data(), piece.size())) lines.push_back(line);
  }
  for (const OutputLine& line : splitter.finish()) lines.push_back(line);
  return lines;
}

std::vector<std::string> texts(const std::vector<OutputLine>& lines, bool updates) {
  std::vector<std::string> found;
  for (const OutputLine& line : lines) {
    if (line.is_update == updates) found.push_back(line.text);
  }
  return found;
}

using testing::ElementsAre;
using testing::IsEmpty;

TEST(OutputSplitter, JoinsLinesThatArriveInPieces) {
  EXPECT_THAT(texts(split({"fi", "rst\nsec", "ond\n"}), false), ElementsAre("first", "second"));
}

TEST(OutputSplitter, KeepsALastLineWithoutEnd) {
  EXPECT_THAT(texts(split({"a\nb"}), false), ElementsAre("a", "b"));
}

TEST(OutputSplitter, KnowsTheLineEndOfATerminal) {
  EXPECT_THAT(texts(split({"a\r\nb\r\n"}), false), ElementsAre("a", "b"));
  EXPECT_THAT(texts(split({"a\r\nb\r\n"}), true), IsEmpty());
}

TEST(OutputSplitter, TellsUpdatesFromLinesThatStay) {
  const auto lines = split({"\rstep 1\rstep 2", "\rstep 3\ndone\n"});
  EXPECT_THAT(texts(lines, true), ElementsAre("step 1", "step 2", "step 3"));
  EXPECT_THAT(texts(lines, false), ElementsAre("done"));
  EXPECT_FALSE(lines[1].ends_line);
  EXPECT_TRUE(lines[2].ends_line);
}

TEST(MpiOutput, TakesTheTagOffAndSaysWhoSpoke) {
  std::string line = "[1,2]<stderr>:solid-server: element 7 is inverted";
  EXPECT_EQ(take_mpi_tag(line), "rank 2");
  EXPECT_EQ(line, "solid-server: element 7 is inverted");
}

TEST(MpiOutput, TakesTheTagsBetweenUpdatesOff) {
  std::string update = "step 5  0.1 s[1,0]<stderr>:";
  EXPECT_EQ(take_mpi_tags(update), "rank 0");
  EXPECT_EQ(update, "step 5  0.1 s");
}

TEST(MpiOutput, ALineWithoutTagIsMpirunsOwn) {
  std::string line = "mpirun noticed that process rank 2 exited";
  EXPECT_EQ(take_mpi_tag(line), "mpirun");
  EXPECT_EQ(line, "mpirun noticed that process rank 2 exited");
}

TEST(MpiOutput, ALastWordBeginsWithAProgram) {
  EXPECT_TRUE(is_last_word("coupler: t = 0.1 s: diverged"));
  EXPECT_FALSE(is_last_word("step 5  t = 0.1 s"));
}

}  // namespace
}  // namespace couplet::launcher
