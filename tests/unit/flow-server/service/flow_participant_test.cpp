#include "flow-server/service/flow_participant.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "flow-server/service/estimate_flow.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/result_reader.hpp"
#include "tests/unit/flow-server/extruded_fold.hpp"

namespace couplet::flow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::Scene scene_of(const std::string& text) {
  v1::Scene scene;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &scene)) << text;
  return scene;
}

std::string fold_scene(const std::string& more = "", const std::string& output = "") {
  return R"scene(title: "fold" time { end: 0.01 step: 1e-5 }
    flow { fluid { density: 1.13 viscosity: 2.27e-4 }
      glottis { model: M2 subglottal_pressure { row { time: 0 value: 1000 } }
        entrance_start { marker: "inferior_middle" } exit_line { marker: "C1" } midplane: 0.0102 half_length: true )scene" +
         more + " } } solid { } output { " + output + " }";
}

const std::string channel_scene = R"scene(title: "channel" time { end: 0.01 step: 1e-5 }
  flow { fluid { density: 1.13 viscosity: 2.27e-4 }
    glottis { model: M1 subglottal_pressure { row { time: 0 value: 1000 } }
      channel { length: 0.012 width: 0.02 height: "1e-3 + 15*(x - 0.009)^2 + 1e-4*sin(600*t)" } } })scene";

surface::SurfaceMesh fold_surface() {
  const ExtrudedFold shape{.outline = fold_outline, .n_across = 12, .n_rows = 3};
  surface::SurfaceMesh mesh = make_surface(shape);
  mesh.marker = {{"C1", node_number(shape, 14, 6)}, {"inferior_middle", node_number(shape, 6, 6)}};
  return mesh;
}

participant::OpenRequest request_for(const std::string& text) {
  participant::OpenRequest request;
  request.scene = scene_of(text);
  if (request.scene.has_solid()) request.peer_surface = fold_surface();
  return request;
}

surface::FieldSet displaced_by(double y) {
  surface::NodeArray u = surface::NodeArray::Zero(fold_surface().n_nodes(), 3);
  u.col(1).setConstant(y);
  return {{"displacement", "m", u}, {"temperature", "K", surface::NodeArray::Zero(u.rows(), 1)}};
}

class ScratchFolder {
 public:
  ScratchFolder() : path_(std::filesystem::temp_directory_path() / ("couplet-flow-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_ / "results");
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

template <typename Error>
std::string refusal_of(const std::string& text) {
  FlowParticipant flow;
  try {
    flow.open(request_for(text));
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FlowParticipant, OffersForceOnTheSurfaceOfTheSolidAndNeedsItsDisplacement) {
  FlowParticipant flow;
  const participant::Opened opened = flow.open(request_for(fold_scene()));
  EXPECT_THAT(opened.needs, ElementsAre("displacement"));
  EXPECT_THAT(opened.offers, ElementsAre("force"));
  EXPECT_EQ(opened.surface.node_position, fold_surface().node_position);
  EXPECT_EQ(opened.surface.face_node, fold_surface().face_node);
  EXPECT_EQ(opened.time, 0);
  const auto& force = surface::find_field(opened.fields, "force").values;
  EXPECT_EQ(force.rows(), opened.surface.n_nodes());
  EXPECT_GT(force.col(0).sum(), 0);
}

TEST(FlowParticipant, IgnoresFieldsThatItDoesNotNeed) {
  FlowParticipant flow;
  flow.open(request_for(fold_scene()));
  const auto solved = flow.solve_step({1, 1, 0, 1e-5}, displaced_by(0));
  EXPECT_THAT(solved.fields, ::testing::SizeIs(1));
}

TEST(FlowParticipant, ReportsTheSameQuantitiesAfterEveryStep) {
  FlowParticipant flow;
  flow.open(request_for(fold_scene()));
  std::vector<std::string> first;
  for (int step = 1; step <= 3; ++step) {
    flow.solve_step({step, 1, (step - 1) * 1e-5, 1e-5}, displaced_by(-1e-5 * step));
    std::vector<std::string> names;
    for (const auto& number : flow.accept_step(step)) names.push_back(number.name + "[" + number.unit + "]");
    if (first.empty()) first = names;
    EXPECT_EQ(first, names);
  }
  EXPECT_THAT(first, ::testing::IsSupersetOf({"flow.rate[m^3/s]", "flow.smallest_area[m^2]", "flow.exit_area[m^2]"}));
}

TEST(FlowParticipant, RefusesAStepThatDoesNotStartAtItsAcceptedTime) {
  FlowParticipant flow;
  flow.open(request_for(fold_scene()));
  EXPECT_THROW(flow.solve_step({2, 1, 1e-5, 1e-5}, displaced_by(0)), report::PeerError);
}

// Both programs add up times; after millions of steps their round-off differs by more than that of one step.
TEST(FlowParticipant, FollowsTheRoundOffOfTheCoupler) {
  FlowParticipant flow;
  flow.open(request_for(fold_scene()));
  for (int step = 1; step <= 5; ++step) {
    const double start = (step - 1) * (1e-5 + 8e-12);  // each start is off by less than 1e-6 of a step, all by more
    EXPECT_NO_THROW(flow.solve_step({step, 1, start, 1e-5}, displaced_by(0))) << step;
    flow.accept_step(step);
  }
}

TEST(FlowParticipant, RefusesAMissingFieldAndOneOfTheWrongSize) {
  FlowParticipant flow;
  flow.open(request_for(fold_scene()));
  EXPECT_THROW(flow.solve_step({1, 1, 0, 1e-5}, {}), report::PeerError);
  EXPECT_THROW(flow.solve_step({1, 1, 0, 1e-5}, {{"displacement", "m", surface::NodeArray::Zero(4, 3)}}),
               report::PeerError);
}

TEST(FlowParticipant, ContinuesFromItsCheckpointWithEqualBits) {
  const ScratchFolder folder;
  const std::string file = folder.path() / "flow.h5";
  FlowParticipant whole;
  whole.open(request_for(fold_scene()));
  const auto step = [](FlowParticipant& flow, int n) {
    const auto solved = flow.solve_step({n, 1, (n - 1) * 1e-5, 1e-5}, displaced_by(-1e-6 * n * n));
    flow.accept_step(n);
    return solved.fields.front().values;
  };
  for (int n = 1; n <= 4; ++n) step(whole, n);
  const std::uint64_t bytes = whole.write_checkpoint(file);
  EXPECT_EQ(bytes, std::filesystem::file_size(file));
  participant::OpenRequest request = request_for(fold_scene());
  request.resume_from = file;
  FlowParticipant resumed;
  const auto opened = resumed.open(request);
  EXPECT_DOUBLE_EQ(opened.time, 4e-5);
  for (int n = 5; n <= 8; ++n) EXPECT_EQ(step(whole, n), step(resumed, n));
}

TEST(FlowParticipant, StoresFieldsAtTheIntervalOfTheSceneAndContinuesThemAfterAResume) {
  const ScratchFolder folder;
  participant::OpenRequest request = request_for(fold_scene("", "results_interval: 2e-5 results_start: 2e-5"));
  request.run_folder = folder.path();
  const auto advance = [](FlowParticipant& flow, int from, int to) {
    for (int n = from; n <= to; ++n) {
      flow.solve_step({n, 1, (n - 1) * 1e-5, 1e-5}, displaced_by(-1e-5 * n));
      flow.accept_step(n);
    }
  };
  {
    FlowParticipant flow;
    flow.open(request);
    advance(flow, 1, 4);
    flow.write_checkpoint(folder.path() / "flow.checkpoint");
    advance(flow, 5, 6);  // a state that the resumed run must replace
    flow.close("test");
  }
  request.resume_from = folder.path() / "flow.checkpoint";
  FlowParticipant resumed;
  resumed.open(request);
  advance(resumed, 5, 8);
  resumed.close("test");
  const store::ResultReader results(folder.path() / "results", "flow");
  ASSERT_EQ(results.n_states(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(results.time(i), 2e-5 * static_cast<double>(i + 1), 1e-12);
  EXPECT_THAT(results.field_names(),
              ::testing::UnorderedElementsAre("displacement", "pressure", "velocity", "area", "effective_area"));
  EXPECT_EQ(results.field(0, "pressure").rows(), 140);
  EXPECT_NEAR(results.field(0, "pressure")(0, 0), 1000, 1e-3);  // single precision
}

TEST(FlowParticipant, RunsAPrescribedChannelAlone) {
  FlowParticipant flow;
  const auto opened = flow.open(request_for(channel_scene));
  EXPECT_TRUE(opened.needs.empty());
  EXPECT_TRUE(opened.offers.empty());
  EXPECT_EQ(opened.surface.n_nodes(), 0);
  flow.solve_step({1, 1, 0, 1e-5}, {});
  EXPECT_GT(flow.accept_step(1).front().value, 0);
}

TEST(FlowParticipant, NamesTheMarkersThereAreWhenOneIsMissing) {
  std::string text = fold_scene();
  text.replace(text.find("\"C1\""), 4, "\"C9\"");
  const std::string found = refusal_of<report::SceneError>(text);
  EXPECT_THAT(found, HasSubstr("flow.glottis.exit_line.marker"));
  EXPECT_THAT(found, HasSubstr("the surface has no marker 'C9'"));
  EXPECT_THAT(found, HasSubstr("choose one of: C1, inferior_middle"));
}

TEST(FlowParticipant, TakesTheNodeNearestToAPosition) {
  std::string text = fold_scene();
  const std::string marker = "marker: \"C1\"";
  text.replace(text.find(marker), marker.size(), "position { x: 0.01195 y: 0.0099 z: 0.0101 }");
  FlowParticipant by_marker, by_position;
  EXPECT_EQ(by_marker.open(request_for(fold_scene())).fields.front().values,
            by_position.open(request_for(text)).fields.front().values);
}

TEST(FlowParticipant, RefusesScenesThatLackWhatTheGlottisNeeds) {
  std::string without_midplane = fold_scene();
  without_midplane.replace(without_midplane.find("midplane: 0.0102"), 16, "");
  EXPECT_THAT(refusal_of<report::SceneError>(without_midplane), HasSubstr("flow.glottis.midplane"));
  std::string without_exit = fold_scene();
  without_exit.replace(without_exit.find("exit_line { marker: \"C1\" }"), 26, "");
  EXPECT_THAT(refusal_of<report::SceneError>(without_exit), HasSubstr("flow.glottis.exit_line"));
  std::string without_entrance = fold_scene();
  without_entrance.replace(without_entrance.find("entrance_start { marker: \"inferior_middle\" }"), 44, "");
  EXPECT_THAT(refusal_of<report::SceneError>(without_entrance), HasSubstr("flow.glottis.entrance_start"));
  EXPECT_THAT(refusal_of<report::SceneError>(fold_scene(R"(channel { length: 1 width: 1 height: "1" })")),
              HasSubstr("a prescribed channel and a solid"));
  EXPECT_THAT(refusal_of<report::SceneError>(R"(flow { glottis { model: B1 } })"),
              HasSubstr("neither a solid nor a channel"));
  EXPECT_THAT(refusal_of<report::SceneError>("flow { }"), HasSubstr("names no model"));
}

TEST(EstimateFlow, GrowsWithStationsAndFaces) {
  const auto value = [](const std::vector<participant::NamedNumber>& numbers, const std::string& name) {
    for (const auto& number : numbers) {
      if (number.name == name) return number.value;
    }
    return -1.0;
  };
  const auto fold = estimate_flow(request_for(fold_scene())), channel = estimate_flow(request_for(channel_scene));
  EXPECT_EQ(value(fold, "stations"), 140);
  EXPECT_EQ(value(fold, "faces"), 36);
  EXPECT_EQ(value(channel, "faces"), -1);
  EXPECT_GT(value(fold, "seconds_per_solve"), value(channel, "seconds_per_solve"));
  EXPECT_GT(value(fold, "memory_bytes"), 0);
  participant::OpenRequest unknown = request_for(fold_scene());
  unknown.peer_surface.reset();
  EXPECT_EQ(value(estimate_flow(unknown), "stations"), 140);
  EXPECT_EQ(value(estimate_flow(unknown), "seconds_per_solve"), -1);
}

}  // namespace
}  // namespace couplet::flow
