#include "proto/store/result_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "proto/report/failure.hpp"
#include "proto/store/result_reader.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::store {
namespace {

using surface::FieldSet;
using surface::NodeArray;

/// Two bricks of 20 nodes side by side; their nodes are not shared, which does not matter here.
ResultMesh two_bricks() {
  const double at[20][3] = {{0, 0, 0},  {1, 0, 0},  {1, 1, 0},  {0, 1, 0},  {0, 0, 1},  {1, 0, 1},  {1, 1, 1},
                            {0, 1, 1},  {.5, 0, 0}, {1, .5, 0}, {.5, 1, 0}, {0, .5, 0}, {.5, 0, 1}, {1, .5, 1},
                            {.5, 1, 1}, {0, .5, 1}, {0, 0, .5}, {1, 0, .5}, {1, 1, .5}, {0, 1, .5}};
  ResultMesh mesh{CellShape::hexahedron20, NodeArray(40, 3), {}};
  for (int node = 0; node < 40; ++node) {
    mesh.node_position.row(node) << at[node % 20][0] + (node < 20 ? 0 : 1), at[node % 20][1], at[node % 20][2];
    mesh.cell_node.push_back(node);
  }
  return mesh;
}

/// Fields that tell the state they belong to by every number.
FieldSet fields_of(int state) {
  return {{"displacement", "m", NodeArray::Constant(40, 3, 0.25 * state)},
          {"pressure", "Pa", NodeArray::Constant(40, 1, state)}};
}

double time_of(int state) {
  return 1e-3 * state;
}

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

/// Every state that the reader sees is whole, and the listing for ParaView is closed and names only such states.
int check_result(const std::filesystem::path& folder) {
  const ResultReader reader(folder, "solid");
  for (std::size_t state = 0; state < reader.n_states(); ++state) {
    const int number = static_cast<int>(std::lround(reader.time(state) / 1e-3));
    const auto expected = fields_of(number);
    EXPECT_EQ(number, static_cast<int>(state));
    EXPECT_EQ(reader.field(state, "displacement"), expected[0].values);
    EXPECT_EQ(reader.field(state, "pressure"), expected[1].values);
    EXPECT_EQ(reader.field(state, "position"), (two_bricks().node_position + expected[0].values).eval());
  }
  const std::string listing = text_of(folder / "solid.xmf");
  EXPECT_THAT(listing, testing::EndsWith("</Grid>\n</Domain>\n</Xdmf>\n"));
  const int n_listed = count(listing, "<Time Value=");
  EXPECT_EQ(count(listing, "<Grid "), n_listed + 1);
  EXPECT_EQ(count(listing, "</Grid>"), n_listed + 1);
  EXPECT_LE(n_listed, static_cast<int>(reader.n_states()));
  return n_listed;
}

TEST(ResultFile, GivesBackEveryStateOverSeveralFiles) {
  const TemporaryFolder folder;
  {
    ResultWriter writer(folder.path(), "solid", two_bricks());
    for (int state = 0; state < 100; ++state) writer.append(time_of(state), fields_of(state));
  }
  EXPECT_EQ(check_result(folder.path()), 100);
  const ResultReader reader(folder.path(), "solid");
  EXPECT_EQ(reader.n_states(), 100U);
  EXPECT_THAT(reader.field_names(), testing::ElementsAre("displacement", "pressure"));
  EXPECT_EQ(reader.mesh().cell_node, two_bricks().cell_node);
  EXPECT_EQ(reader.mesh().node_position, two_bricks().node_position);
  EXPECT_TRUE(std::filesystem::exists(folder / "solid.0001.h5"));
}

TEST(ResultFile, IsCompleteAfterEveryAppend) {
  const TemporaryFolder folder;
  ResultWriter writer(folder.path(), "solid", two_bricks());
  for (int state = 0; state < 40; ++state) {
    writer.append(time_of(state), fields_of(state));
    ASSERT_EQ(check_result(folder.path()), state + 1);
  }
}

TEST(ResultFile, ListsNearlyAllStatesOfALongRunAtAnyMoment) {
  const TemporaryFolder folder;
  ResultMesh mesh{CellShape::polyline, NodeArray::Random(2, 3), {0, 1}};
  const auto n_listed = [&] { return count(text_of(folder / "line.xmf"), "<Time Value="); };
  {
    ResultWriter writer(folder.path(), "line", mesh);
    for (int state = 0; state < 1500; ++state) {
      writer.append(state, {{"pressure", "Pa", NodeArray::Zero(2, 1)}});
      if (state % 97 == 0) {
        EXPECT_GE(n_listed(), state + 1 - state / 256 - 1);
      }
    }
  }
  EXPECT_EQ(n_listed(), 1500);
}

TEST(ResultFile, IsReadableAfterAKillAtAnyMoment) {
  const TemporaryFolder folder;
  std::srand(1);
  for (int trial = 0; trial < 40; ++trial) {
    std::filesystem::remove_all(folder.path());
    std::filesystem::create_directories(folder.path());
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ResultWriter writer(folder.path(), "solid", two_bricks());
      for (int state = 0;; ++state) writer.append(time_of(state), fields_of(state));
    }
    usleep(static_cast<useconds_t>(std::rand() % 30000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    // Before the first state is complete there may be nothing yet.
    if (!std::filesystem::exists(folder / "solid.xmf")) continue;
    check_result(folder.path());
  }
}

TEST(ResultFile, ContinuesAtAnEarlierTimeAndDropsWhatCameLater) {
  for (const int n_kept : {1, 5, 16, 17, 30}) {
    const TemporaryFolder folder;
    {
      ResultWriter writer(folder.path(), "solid", two_bricks());
      for (int state = 0; state < 60; ++state) writer.append(time_of(state), fields_of(state));
    }
    {
      auto writer = ResultWriter::continue_from(folder.path(), "solid", two_bricks(), time_of(n_kept - 1));
      EXPECT_EQ(check_result(folder.path()), n_kept);
      for (int state = n_kept; state < 40; ++state) writer.append(time_of(state), fields_of(state));
    }
    EXPECT_EQ(check_result(folder.path()), 40);
    EXPECT_EQ(ResultReader(folder.path(), "solid").n_states(), 40U);
  }
}

TEST(ResultFile, ContinuesWithNothingWhereNothingIs) {
  const TemporaryFolder folder;
  auto writer = ResultWriter::continue_from(folder.path(), "solid", two_bricks(), 1.0);
  writer.append(time_of(0), fields_of(0));
  EXPECT_EQ(check_result(folder.path()), 1);
}

TEST(ResultFile, StartsAnewOverAnEarlierRun) {
  const TemporaryFolder folder;
  {
    ResultWriter writer(folder.path(), "solid", two_bricks());
    for (int state = 0; state < 60; ++state) writer.append(time_of(state), fields_of(state));
  }
  ResultWriter(folder.path(), "solid", two_bricks()).append(time_of(0), fields_of(0));
  EXPECT_EQ(check_result(folder.path()), 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "solid.0001.h5"));
}

TEST(ResultFile, RefusesToContinueOnAnotherMesh) {
  const TemporaryFolder folder;
  ResultWriter(folder.path(), "solid", two_bricks()).append(0, fields_of(0));
  ResultMesh other = two_bricks();
  other.node_position(3, 1) += 1e-6;
  EXPECT_THROW(ResultWriter::continue_from(folder.path(), "solid", other, 1.0), report::FileError);
}

TEST(ResultFile, DrawsAPolylineAsSegments) {
  const TemporaryFolder folder;
  ResultMesh mesh{CellShape::polyline, NodeArray::Random(4, 3), {3, 1, 0, 2}};
  ResultWriter(folder.path(), "line", mesh).append(0, {{"pressure", "Pa", NodeArray::Zero(4, 1)}});
  EXPECT_THAT(ResultReader(folder.path(), "line").mesh().cell_node, testing::ElementsAre(3, 1, 1, 0, 0, 2));
  EXPECT_THAT(text_of(folder / "line.xmf"),
              testing::HasSubstr("TopologyType=\"Polyline\" NodesPerElement=\"2\" NumberOfElements=\"3\""));
  EXPECT_THAT(text_of(folder / "line.xmf"), testing::HasSubstr("line.h5:/mesh/position"));
}

TEST(ResultFile, HoldsCellsOfEveryShape) {
  const TemporaryFolder folder;
  const auto write = [&](CellShape shape, const std::vector<std::int64_t>& cell_node) {
    ResultWriter(folder.path(), "body", {shape, two_bricks().node_position, cell_node}).append(0, fields_of(0));
    const ResultReader reader(folder.path(), "body");
    EXPECT_EQ(reader.mesh().shape, shape);
    EXPECT_EQ(reader.mesh().cell_node, cell_node);
    return text_of(folder / "body.xmf");
  };
  EXPECT_THAT(write(CellShape::hexahedron8, {0, 1, 2, 3, 4, 5, 6, 7}),
              testing::HasSubstr("<Topology TopologyType=\"Hexahedron\" NumberOfElements=\"1\">"));
  EXPECT_THAT(write(CellShape::tetrahedron10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9}),
              testing::HasSubstr("<Topology TopologyType=\"Tetrahedron_10\" NumberOfElements=\"2\">"));
  EXPECT_THAT(write(CellShape::triangle, {0, 1, 2, 0, 2, 3}),
              testing::HasSubstr("<Topology TopologyType=\"Triangle\" NumberOfElements=\"2\">"));
  EXPECT_THAT(write(CellShape::quadrilateral, {0, 1, 2, 3}),
              testing::HasSubstr("<Topology TopologyType=\"Quadrilateral\" NumberOfElements=\"1\">"));
  EXPECT_THAT(write(CellShape::mixed, {4, 0, 1, 2, 5, 0, 1, 2, 3}), testing::HasSubstr("NumberOfElements=\"2\""));
  const std::string mixed =
      write(CellShape::mixed, {9,  0,  1,  2,  3,  4,  5,  6,  7,  38, 0,  1,  2,  3,  4,  5,  6,  7,  8,  9, 48,
                               20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39});
  EXPECT_THAT(mixed, testing::HasSubstr("<Topology TopologyType=\"Mixed\" NumberOfElements=\"3\">"));
  EXPECT_THAT(mixed, testing::HasSubstr("Dimensions=\"41 1\""));
}

TEST(ResultFile, HoldsFieldsOfCellsTensorsAndNumbersAlsoWhenItIsContinued) {
  const TemporaryFolder folder;
  ResultMesh mesh = two_bricks();
  mesh.cell_number = {{"body_number", {0, 1}}, {"region_number", {4, 2}}};
  const auto append = [](ResultWriter& writer, int state) {
    FieldSet fields = fields_of(state);
    fields.push_back({"cauchy_stress", "Pa", NodeArray::Constant(40, 9, 10 * state)});
    writer.append(time_of(state), fields, {{"fibre_direction", "1", NodeArray::Constant(2, 3, state)}});
  };
  {
    ResultWriter writer(folder.path(), "solid", mesh);
    for (int state = 0; state < 20; ++state) append(writer, state);
  }
  auto writer = ResultWriter::continue_from(folder.path(), "solid", mesh, time_of(17));
  for (int state = 18; state < 30; ++state) append(writer, state);
  const ResultReader reader(folder.path(), "solid");
  ASSERT_EQ(reader.n_states(), 30U);
  EXPECT_THAT(reader.field_names(), testing::ElementsAre("displacement", "pressure", "cauchy_stress"));
  EXPECT_THAT(reader.cell_field_names(), testing::ElementsAre("fibre_direction"));
  ASSERT_EQ(reader.mesh().cell_number.size(), 2U);
  EXPECT_EQ(reader.mesh().cell_number[1].name, "region_number");
  EXPECT_THAT(reader.mesh().cell_number[1].value, testing::ElementsAre(4, 2));
  for (std::size_t state = 0; state < 30; ++state) {
    EXPECT_EQ(reader.field(state, "cauchy_stress"), NodeArray::Constant(40, 9, 10.0 * static_cast<double>(state)));
    EXPECT_EQ(reader.field(state, "fibre_direction"), NodeArray::Constant(2, 3, static_cast<double>(state)));
  }
  const std::string listing = text_of(folder / "solid.xmf");
  EXPECT_EQ(count(listing, "Name=\"cauchy_stress\" AttributeType=\"Tensor\" Center=\"Node\""), 30);
  EXPECT_EQ(count(listing, "Name=\"fibre_direction\" AttributeType=\"Vector\" Center=\"Cell\""), 30);
  EXPECT_EQ(count(listing, "solid.h5:/mesh/region_number"), 30);
  mesh.cell_number[1].value[0] = 3;
  EXPECT_THROW(ResultWriter::continue_from(folder.path(), "solid", mesh, 1.0), report::FileError);
}

TEST(ResultFile, SaysWhenTheDiskIsFullAndKeepsWhatThereIs) {
  const TemporaryFolder folder;
  const auto fill = [&] {
    ResultWriter writer(folder.path(), "solid", two_bricks());
    for (int state = 0; state < 16; ++state) writer.append(time_of(state), fields_of(state));
    limit_file_size(30000);  // less than the next file needs
    try {
      for (int state = 16; state < 100; ++state) writer.append(time_of(state), fields_of(state));
    } catch (const report::FileError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      std::exit(7);
    }
    std::exit(9);
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(7), "solid.*h5");
  EXPECT_EQ(check_result(folder.path()), 16);
}

}  // namespace
}  // namespace couplet::store
