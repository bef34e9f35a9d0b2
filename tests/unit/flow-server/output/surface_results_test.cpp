#include "flow-server/output/surface_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "flow-server/immersed/body_shape.hpp"
#include "proto/store/result_reader.hpp"
#include "tests/unit/flow-server/immersed/surface_of.hpp"

namespace couplet::flow {
namespace {

TEST(SurfaceResults, KeepTheSurfaceOverTimeAndGoOnAfterAStop) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "couplet surface results";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  BodySurface plate = surface_of(make_rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.75), false);
  plate.name = "plate";
  const BodySurface at_rest = plate;
  const auto n_triangles = static_cast<Eigen::Index>(plate.triangle.size());
  const auto store = [&](SurfaceResults& results, double time) {
    for (std::size_t i = 0; i < plate.position.size(); ++i) {
      plate.position[i][2] = at_rest.position[i][2] + time;
      plate.velocity[i][2] = 1;
    }
    results.append(time, plate,
                   {{"pressure_jump", "Pa", surface::NodeArray::Constant(n_triangles, 1, 8 * time), true}});
  };
  {
    SurfaceResults results(folder, at_rest, 0);
    store(results, 0);
    store(results, 0.25);
    store(results, 0.5);
  }
  {
    SurfaceResults results(folder, at_rest, 0.25);  // resumed from there: the state at 0.5 is dropped
    store(results, 0.75);
  }
  const store::ResultReader reader(folder, "plate");
  ASSERT_EQ(reader.n_states(), 3u);
  EXPECT_EQ(reader.time(2), 0.75);
  EXPECT_EQ(reader.mesh().shape, store::CellShape::triangle);
  EXPECT_EQ(reader.field(2, "displacement").col(2).minCoeff(), 0.75);
  EXPECT_EQ(reader.field(2, "velocity").col(2).maxCoeff(), 1);
  EXPECT_EQ(reader.field(2, "pressure_jump").rows(), n_triangles);
  std::ostringstream listing;
  listing << std::ifstream(folder / "plate.xmf").rdbuf();
  EXPECT_THAT(listing.str(), testing::HasSubstr("TopologyType=\"Triangle\" NumberOfElements=\"8\""));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace couplet::flow
