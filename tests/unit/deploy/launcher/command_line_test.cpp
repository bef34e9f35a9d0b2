// A wrong command line is refused in one line that names what was probably meant.

#include "deploy/launcher/command_line.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>

#include "deploy/launcher/make_keys.hpp"
#include "proto/report/failure.hpp"

namespace couplet::launcher {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string refusal(std::vector<std::string> words) {
  words.insert(words.begin(), "couplet");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  try {
    run_command_line(static_cast<int>(arguments.size()), arguments.data());
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "was not refused";
}

TEST(CommandLine, SuggestsTheNearestVerb) {
  EXPECT_EQ(refusal({"rnu", "scene.txtpb"}), "there is no verb rnu; did you mean run?");
}

TEST(CommandLine, SuggestsTheNearestOption) {
  EXPECT_EQ(refusal({"run", "scene.txtpb", "--tansport", "mpi"}),
            "run: there is no option --tansport; did you mean --transport?");
}

TEST(CommandLine, NamesTheMissingScene) {
  EXPECT_THAT(refusal({"run"}), HasSubstr("run: SCENE is required"));
}

TEST(CommandLine, NamesTheTransportsThereAre) {
  const std::string line = refusal({"run", "scene.txtpb", "--transport", "tcp"});
  EXPECT_THAT(line, HasSubstr("mpi"));
  EXPECT_THAT(line, HasSubstr("zmq"));
  EXPECT_THAT(line, Not(HasSubstr("\n")));
}

TEST(CommandLine, RefusesABenchmarkThatDoesNotExist) {
  EXPECT_THAT(refusal({"bench", "no-such-thing"}), HasSubstr("there is none of this name"));
}

TEST(Keys, SecretKeysAreReadableByTheirOwnerOnlyAndNeverReplaced) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "couplet_keys_test";
  std::filesystem::remove_all(folder);
  make_keys(folder);
  for (const char* program : {"coupler", "flow-server", "solid-server"}) {
    struct stat key {};
    ASSERT_EQ(stat((folder / (std::string(program) + ".key")).c_str(), &key), 0);
    EXPECT_EQ(key.st_mode & 0777, 0600u) << program;
    EXPECT_EQ(key.st_size, 41) << "40 characters of Z85 and an end of line";
  }
  EXPECT_THROW(make_keys(folder), report::SceneError);
}

}  // namespace
}  // namespace couplet::launcher
