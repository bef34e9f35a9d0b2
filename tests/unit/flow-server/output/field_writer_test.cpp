// Started on 1, 2 and 4 ranks.
#include "flow-server/output/field_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/state_from_formula.hpp"

namespace couplet::flow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

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
                              "Dimensions=\"9 11 13 3\" Format=\"HDF\">flow.000001.h5:/flow/velocity<"));
  EXPECT_THAT(text, HasSubstr("Format=\"HDF\">flow.h5:/grid/flow/x<"));
}

/// Names of all files in a folder, in rising order.
std::vector<std::string> files_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// Leaves the results of states at 0, 1, 2 and 3 s.
void write_four_states(const std::filesystem::path& folder) {
  FormulaFlow flow = linear_flow();
  FieldWriter writer(folder, flow.grid, flow.decomposition, {whole(flow.grid)}, 0);
  for (const double time : {0.0, 1.0, 2.0, 3.0}) {
    flow.state.time = time;
    writer.append(flow.part());
  }
}

TEST(FieldWriter, ContinuesAndDropsWhatIsLater) {
  const SharedFolder folder("field-continued");
  write_four_states(folder.path());
  FormulaFlow flow = linear_flow();
  {
    FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 1.5);
    EXPECT_THAT(text_of(folder.path() / "flow.xmf"), Not(HasSubstr("Value=\"2\"")));
    EXPECT_THAT(files_in(folder.path()), ElementsAre("flow.000000.h5", "flow.000001.h5", "flow.h5", "flow.xmf"));
    flow.state.time = 1.75;
    writer.append(flow.part());
  }
  EXPECT_THAT(files_in(folder.path()),
              ElementsAre("flow.000000.h5", "flow.000001.h5", "flow.000002.h5", "flow.h5", "flow.xmf"));
  EXPECT_EQ(read_all(folder.path() / "flow.h5", "state/000001/time", {1}).front(), 1);
  EXPECT_EQ(read_all(folder.path() / "flow.h5", "state/000002/time", {1}).front(), 1.75);
  EXPECT_THAT(text_of(folder.path() / "flow.xmf"), HasSubstr("<Time Value=\"1\"/>"));
  EXPECT_THAT(text_of(folder.path() / "flow.xmf"), HasSubstr("<Time Value=\"1.75\"/>"));
}

TEST(FieldWriter, StartsAnewWithoutWhatIsThere) {
  const SharedFolder folder("field-anew");
  write_four_states(folder.path());
  const FormulaFlow flow = linear_flow();
  const FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {part_with_stride()}, 0);
  EXPECT_THAT(files_in(folder.path()), ElementsAre("flow.h5", "flow.xmf", "part.xmf"));
}

TEST(FieldWriter, RemovesWhatAKillLeftUnfinishedAndNothingElse) {
  const SharedFolder folder("field-unfinished");
  write_four_states(folder.path());
  const std::vector<std::string> others{"fold.h5.part", "flow.0001.h5", "flow.txt.part"};
  if (rank_of_test() == 0) {
    for (const std::string name : {"flow.h5.part", "flow.xmf.part", "flow.000004.h5.part"})
      std::ofstream(folder.path() / name) << "a torn ";
    for (const std::string& name : others) std::ofstream(folder.path() / name) << "of somebody else";
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const FormulaFlow flow = linear_flow();
  const FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 0.5);
  EXPECT_THAT(files_in(folder.path()), UnorderedElementsAre("flow.000000.h5", "flow.h5", "flow.xmf", "fold.h5.part",
                                                            "flow.0001.h5", "flow.txt.part"));
}

TEST(FieldWriter, KeepsAStateThatAKillLeftUnnamed) {
  const SharedFolder folder("field-unnamed");
  write_four_states(folder.path());
  MPI_Barrier(MPI_COMM_WORLD);
  // The kill fell between the state and the files that name it: these are still those of the state before.
  if (rank_of_test() == 0) std::filesystem::rename(folder.path() / "flow.000003.h5", folder.path() / "flow.000004.h5");
  MPI_Barrier(MPI_COMM_WORLD);
  const FormulaFlow flow = linear_flow();
  const FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 3);
  EXPECT_EQ(read_all(folder.path() / "flow.h5", "state/000004/time", {1}).front(), 3);
  EXPECT_THAT(text_of(folder.path() / "flow.xmf"), HasSubstr("flow.000004.h5:/flow/velocity"));
}

TEST(FieldWriter, NamesEveryStateInTheEndHoweverManyThereAre) {
  const SharedFolder folder("field-many");
  FormulaFlow flow{stretched_box({8, 8, 8}),
                   {[](const Point&) { return 0; }, [](const Point&) { return 0; }, [](const Point&) { return 0; }},
                   [](const Point&) { return 0; }};
  const std::string last = "<Time Value=\"257\"/>";
  {
    FieldWriter writer(folder.path(), flow.grid, flow.decomposition, {whole(flow.grid)}, 0);
    for (int state = 0; state < 258; ++state) {  // from 256 states on every other append replaces the files
      flow.state.time = state;
      writer.append(flow.part());
    }
    EXPECT_THAT(text_of(folder.path() / "flow.xmf"), Not(HasSubstr(last)));
    MPI_Barrier(MPI_COMM_WORLD);  // no writer ends before all have looked
  }
  MPI_Barrier(MPI_COMM_WORLD);  // the first rank names the last states when its writer ends
  EXPECT_EQ(read_all(folder.path() / "flow.h5", "state/000257/time", {1}).front(), 257);
  EXPECT_THAT(text_of(folder.path() / "flow.xmf"), HasSubstr(last));
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
