// Started on 1, 2 and 4 ranks.
#include "flow-server/output/field_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/state_from_formula.hpp"

namespace couplet::flow {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

FormulaFlow linear_flow() {
  return {
      stretched_box({13, 11, 9}),
      {[](const Point& x) { return x[1]; }, [](const Point& x) { return -x[0]; }, [](const Point& x) { return x[2]; }},
      [](const Point& x) { return x[0] + 10 * x[1] + 100 * x[2]; }};
}

FieldRegion whole(const StretchedGrid& grid) {
  return {"flow", box_of(grid.n_cells()), 1, {FieldQuantity::velocity, FieldQuantity::pressure}, Precision::full};
}

FieldRegion part_with_stride() {
  return {
      "part", {{2, 1, 3}, {12, 11, 9}}, 3, {FieldQuantity::vorticity, FieldQuantity::q_criterion}, Precision::single};
}

std::vector<double> read_all(const std::filesystem::path& path, const std::string& name, std::vector<hsize_t> shape) {
  const ParallelFile file = ParallelFile::open_for_reading(path, MPI_COMM_WORLD);
  std::vector<double> values(1);
  for (const hsize_t n : shape) values.resize(values.size() * n);
  file.read(name, {shape, std::vector<hsize_t>(shape.size(), 0), shape}, values.data());
  return values;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(FieldWriter, StoresTheWholeGridInOrderOnAnyNumberOfRanks) {
  const SharedFolder folder("field-writer");
  const FormulaFlow flow = linear_flow();
  {
    FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 0);
    writer.append(flow.part());
  }
  const auto velocity = read_all(folder.path() / "flow.h5", "state/000000/flow/velocity", {9, 11, 13, 3});
  const auto pressure = read_all(folder.path() / "flow.h5", "state/000000/flow/pressure", {9, 11, 13});
  std::size_t at = 0;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 13; ++i, ++at) {
        const double x = flow.grid.axis[0].centre(i), y = flow.grid.axis[1].centre(j), z = flow.grid.axis[2].centre(k);
        EXPECT_NEAR(velocity[3 * at], y, 1e-14);  // a mean of two faces rounds once
        EXPECT_NEAR(velocity[3 * at + 1], -x, 1e-14);
        EXPECT_NEAR(velocity[3 * at + 2], z, 1e-14);
        EXPECT_EQ(pressure[at], x + 10 * y + 100 * z);
      }
  const auto faces = read_all(folder.path() / "flow.h5", "grid/flow/x", {14});
  EXPECT_EQ(faces, flow.grid.axis[0].faces().size() == 14 ? flow.grid.axis[0].faces() : std::vector<double>{});
}

TEST(FieldWriter, StoresPartsWithAStride) {
  const SharedFolder folder("field-stride");
  const FormulaFlow flow = linear_flow();
  {
    FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {part_with_stride()}, 0);
    writer.append(flow.part());
  }
  // 10 cells in steps of 3 make 4 cells of a picture, the last one a single cell wide.
  const auto vorticity = read_all(folder.path() / "flow.h5", "state/000000/part/vorticity", {2, 4, 4, 3});
  for (std::size_t i = 0; i < vorticity.size(); i += 3) EXPECT_NEAR(vorticity[i + 2], -2, 1e-6);  // single precision
  const auto faces = read_all(folder.path() / "flow.h5", "grid/part/x", {5});
  for (std::size_t m = 0; m < 4; ++m) EXPECT_EQ(faces[m], flow.grid.axis[0].face(2 + 3 * static_cast<int>(m)));
  EXPECT_EQ(faces[4], flow.grid.axis[0].face(12));
}

TEST(FieldWriter, ListsEveryStateForParaView) {
  const SharedFolder folder("field-listing");
  FormulaFlow flow = linear_flow();
  FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 0);
  EXPECT_THAT(text_of(folder.path() / "flow.xmf"), Not(HasSubstr("<Time")));
  for (const double time : {0.0, 0.25}) {
    flow.state.time = time;
    writer.append(flow.part());
  }
  const std::string text = text_of(folder.path() / "flow.xmf");
  EXPECT_THAT(text, HasSubstr("<Time Value=\"0.25\"/>"));
  EXPECT_THAT(text, HasSubstr("TopologyType=\"3DRectMesh\" Dimensions=\"10 12 14\""));
  EXPECT_THAT(text, HasSubstr("AttributeType=\"Vector\" Center=\"Cell\"><DataItem NumberType=\"Float\" Precision=\"8\" "
                              "Dimensions=\"9 11 13 3\" Format=\"HDF\">flow.h5:/state/000001/flow/velocity<"));
}

TEST(FieldWriter, ContinuesAndDropsWhatIsLater) {
  const SharedFolder folder("field-continued");
  FormulaFlow flow = linear_flow();
  {
    FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 0);
    for (const double time : {0.0, 1.0, 2.0, 3.0}) {
      flow.state.time = time;
      writer.append(flow.part());
    }
  }
  {
    FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 1.5);
    EXPECT_THAT(text_of(folder.path() / "flow.xmf"), Not(HasSubstr("Value=\"2\"")));
    flow.state.time = 1.75;
    writer.append(flow.part());
  }
  const ParallelFile file = ParallelFile::open_for_reading(folder.path() / "flow.h5", MPI_COMM_WORLD);
  EXPECT_EQ(file.names_in("state").size(), 3u);
  EXPECT_EQ(file.read_list("state/000002/time").front(), 1.75);
}

TEST(FieldWriter, RefusesToContinueOtherRegions) {
  const SharedFolder folder("field-other");
  const FormulaFlow flow = linear_flow();
  { FieldWriter(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 0); }
  EXPECT_THROW(FieldWriter(folder.path(), flow.grid, flow.decomposition, {part_with_stride()}, 1), report::FileError);
}

TEST(FieldWriter, SaysWhenTheFolderCannotBeWritten) {
  const FormulaFlow flow = linear_flow();
  EXPECT_THROW(FieldWriter("/dev/null/results", flow.grid, flow.decomposition, {whole(flow.grid)}, 0),
               report::FileError);
}

TEST(ParallelFile, KeepsTextsListsAndArrays) {
  const SharedFolder folder("parallel-file");
  const std::filesystem::path path = folder.path() / "file.h5";
  {
    ParallelFile file = ParallelFile::create(path, MPI_COMM_WORLD);
    file.write_text("a/kind", "some words");
    file.write_list("a/list", {1, 2.5, -3});
    file.close();
  }
  const ParallelFile file = ParallelFile::open_for_reading(path, MPI_COMM_WORLD);
  EXPECT_EQ(file.read_text("a/kind"), "some words");
  EXPECT_EQ(file.read_list("a/list"), (std::vector<double>{1, 2.5, -3}));
  EXPECT_FALSE(file.contains("b/list"));
  EXPECT_THROW(file.read_list("b/list"), report::FileError);
  double value = 0;
  EXPECT_THROW(file.read("a/list", {{4}, {0}, {1}}, &value), report::FileError);
}

TEST(ParallelFile, RefusesWhatIsNoHdf5File) {
  const SharedFolder folder("parallel-file-none");
  if (rank_of_test() == 0) std::ofstream(folder.path() / "text.h5") << "no such thing";
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_THROW(ParallelFile::open_for_reading(folder.path() / "text.h5", MPI_COMM_WORLD), report::FileError);
  EXPECT_THROW(ParallelFile::open_for_reading(folder.path() / "none.h5", MPI_COMM_WORLD), report::FileError);
}

}  // namespace
}  // namespace couplet::flow
