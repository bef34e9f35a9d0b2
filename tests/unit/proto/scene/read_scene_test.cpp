// Scenes in files.

#include "proto/scene/read_scene.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "proto/report/failure.hpp"
#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

class SceneFiles : public testing::Test {
 protected:
  SceneFiles() : folder_(std::filesystem::temp_directory_path() / ("couplet-scenes-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~SceneFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& text) const {
    std::ofstream(folder_ / "scene.txtpb") << text;
    return folder_ / "scene.txtpb";
  }

  std::filesystem::path folder_;
};

TEST_F(SceneFiles, AreReadWithTheirFolder) {
  const SceneFile file = load_scene(write(good_scene), {"time.end=0.25"});
  EXPECT_EQ(file.folder, folder_);
  EXPECT_EQ(file.path, folder_ / "scene.txtpb");
  EXPECT_EQ(file.scene.time().end(), 0.25);
}

TEST_F(SceneFiles, ThrowEveryComplaintAtOnce) {
  const std::filesystem::path path = write(with("density: 1040", "density: -1", with("model: M2", "model: M4")));
  try {
    load_scene(path, {"time.stp=1"});
    FAIL() << "a wrong scene was accepted";
  } catch (const report::SceneError& error) {
    EXPECT_EQ(report::exit_code(error.kind()), 2);
    EXPECT_EQ(std::string(error.what()),
              path.string() + ":7:5: flow.glottis.model: M4 is not a choice here; choose B1, B2, M1, M2\n" +
                  path.string() +
                  ":23:7: solid.body[0].material.density: -1 is not above 0; give a value above 0 kg/m^3\n"
                  "--set time.stp=1: stp is not a field of Time; did you mean step?");
  }
}

TEST_F(SceneFiles, ThatDoNotExistAreAFileError) {
  try {
    read_scene(folder_ / "other.txtpb", {});
    FAIL() << "a missing file was read";
  } catch (const report::FileError& error) {
    EXPECT_EQ(report::exit_code(error.kind()), 5);
    EXPECT_EQ(std::string(error.what()),
              (folder_ / "other.txtpb").string() +
                  ": cannot be read: No such file or directory; give the path of a scene, a text "
                  "file such as scene.txtpb");
  }
}

TEST_F(SceneFiles, ThatAreFoldersAreAFileError) {
  try {
    read_scene(folder_, {});
    FAIL() << "a folder was read";
  } catch (const report::FileError& error) {
    EXPECT_EQ(std::string(error.what()),
              folder_.string() + ": is a folder; give the path of a scene, a text file such as scene.txtpb");
  }
}

}  // namespace
}  // namespace couplet::scene
