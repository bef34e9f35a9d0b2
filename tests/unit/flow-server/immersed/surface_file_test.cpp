#include "flow-server/immersed/surface_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/surface_topology.hpp"
#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

using testing::HasSubstr;

class SurfaceFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("couplet surface " + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string refusal(const std::filesystem::path& file) const {
    try {
      read_surface_file(file);
    } catch (const report::FileError& failure) {
      return failure.what();
    }
    return "accepted";
  }
  /// The box in the units of the file, as its triangles.
  BodySurface box_ = surface_of(make_box({0, 0, 0}, {1, 2, 4}, 1.5), true);
  std::filesystem::path folder_;

  std::string text_stl() const {
    std::string text = "solid box\n";
    for (const auto& corners : box_.triangle) {
      text += "facet normal 0 0 0\n outer loop\n";
      for (const int corner : corners) {
        text += "  vertex";
        for (const double x : box_.position[static_cast<std::size_t>(corner)]) text += " " + std::to_string(x);
        text += "\n";
      }
      text += " endloop\nendfacet\n";
    }
    return text + "endsolid box\n";
  }
  std::string binary_stl() const {
    std::string bytes(80, ' ');
    const auto put = [&bytes](const auto& value) {
      char raw[sizeof(value)];
      std::memcpy(raw, &value, sizeof(value));
      bytes.append(raw, sizeof(value));
    };
    put(static_cast<std::uint32_t>(box_.triangle.size()));
    for (const auto& corners : box_.triangle) {
      for (int d = 0; d < 3; ++d) put(0.0f);
      for (const int corner : corners)
        for (const double x : box_.position[static_cast<std::size_t>(corner)]) put(static_cast<float>(x));
      put(std::uint16_t{0});
    }
    return bytes;
  }
  void expect_box(const std::filesystem::path& file) const {
    const surface::SurfaceMesh mesh = read_surface_file(file, 0.001);
    EXPECT_EQ(mesh.n_nodes(), static_cast<std::int64_t>(box_.position.size()));
    EXPECT_EQ(mesh.n_faces(), static_cast<std::int64_t>(box_.triangle.size()));
    BodySurface read = surface_of(mesh, true);
    const SurfaceTopology topology = orient_surface(read, FluidSide::outside, {});
    EXPECT_TRUE(topology.notes.empty());
    EXPECT_NEAR(topology.volume, 8e-9, 1e-15);  // files hold seven digits
  }
};

TEST_F(SurfaceFile, ReadsTextAndBinaryStlAsOneClosedSurface) {
  expect_box(write("box.stl", text_stl()));
  expect_box(write("binary box.STL", binary_stl()));
}

TEST_F(SurfaceFile, ReadsObjWithPolygons) {
  const auto file = write("cube.obj",
                          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  BodySurface cube = surface_of(read_surface_file(file), true);
  EXPECT_EQ(cube.triangle.size(), 12u);
  EXPECT_NEAR(orient_surface(cube, FluidSide::outside, {}).volume, 1, 1e-12);
}

TEST_F(SurfaceFile, ReadsPly) {
  const auto file =
      write("tetrahedron.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
  BodySurface body = surface_of(read_surface_file(file), true);
  EXPECT_NEAR(orient_surface(body, FluidSide::outside, {}).volume, 1.0 / 6, 1e-12);
}

TEST_F(SurfaceFile, RefusesByTheNameOfTheFile) {
  EXPECT_THAT(refusal(folder_ / "absent.stl"), HasSubstr("absent.stl: there is no such file"));
  EXPECT_THAT(refusal(write("body.step", "ISO-10303-21;")), HasSubstr("ends in '.step'"));
  EXPECT_THAT(refusal(write("broken.ply", "ply\nformat nonsense\n")), HasSubstr("broken.ply"));
  EXPECT_THAT(refusal(write("empty.stl", "solid nothing\nendsolid nothing\n")), HasSubstr("empty.stl"));
}

}  // namespace
}  // namespace couplet::flow
