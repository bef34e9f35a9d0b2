#include "proto/store/summary.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "proto/report/version.hpp"
#include "tests/unit/proto/store/temporary_folder.hpp"

namespace couplet::store {
namespace {

nlohmann::json written(const Summary& summary) {
  const TemporaryFolder folder;
  write_summary(folder / "summary.json", summary);
  return nlohmann::json::parse(text_of(folder / "summary.json"));
}

TEST(Summary, HoldsEveryKeyOfTheContract) {
  Summary summary;
  summary.status = "finished";
  summary.scene = "scene.txtpb";
  summary.steps = 12;
  summary.end_time = 0.25;
  summary.wall_seconds = 1.5;
  summary.core_seconds = 2.5;
  summary.coupled = true;
  summary.iterations_mean = 3.25;
  summary.iterations_max = 7;
  summary.residual_at_acceptance_max = 1e-6;
  summary.force_error_max = 1e-16;
  summary.moment_error_max = 2e-16;
  summary.work_error_max = 3e-16;
  summary.programs = {
      {"solid-server",
       1.25,
       1e8,
       {{.name = "substeps", .value = 4, .unit = "1"}, {.name = "time_integration", .text = "AUTO, because"}}}};
  summary.quantities = {{"frequency", 136.5, "Hz", 0.1, 27}, {"peak_flow", 3e-4, "m^3/s"}};
  const auto expected = nlohmann::json::parse(R"({
    "status": "finished", "scene": "scene.txtpb", "steps": 12, "end_time": 0.25, "wall_seconds": 1.5, "core_seconds": 2.5,
    "coupling": {"iterations_mean": 3.25, "iterations_max": 7, "residual_at_acceptance_max": 1e-6},
    "conservation": {"force_error_max": 1e-16, "moment_error_max": 2e-16, "work_error_max": 3e-16},
    "programs": {"solid-server": {"seconds": 1.25, "peak_memory_bytes": 1e8, "substeps": 4.0,
                                  "time_integration": "AUTO, because"}},
    "quantities": {"frequency": {"value": 136.5, "unit": "Hz", "spread": 0.1, "cycles": 27.0},
                   "peak_flow": {"value": 3e-4, "unit": "m^3/s"}}})");
  auto found = written(summary);
  EXPECT_EQ(found["version"], report::version());
  EXPECT_EQ(found["commit"], report::commit());
  found.erase("version");
  found.erase("commit");
  EXPECT_EQ(found, expected);
}

TEST(Summary, LeavesOutWhatDoesNotApply) {
  Summary summary;
  summary.status = "finished";
  const auto found = written(summary);
  for (const char* key : {"failure", "coupling", "conservation", "programs", "quantities"})
    EXPECT_FALSE(found.contains(key)) << key;
}

TEST(Summary, WritesNullForNumbersThatAreNotFinite) {
  Summary summary;
  summary.status = "failed";
  summary.failure = "solid: element 3 is inverted at t = 0.1 s";
  summary.coupled = true;
  summary.residual_at_acceptance_max = std::numeric_limits<double>::infinity();
  summary.quantities = {{"frequency", std::numeric_limits<double>::quiet_NaN(), "Hz"}};
  const auto found = written(summary);
  EXPECT_EQ(found["failure"], "solid: element 3 is inverted at t = 0.1 s");
  EXPECT_TRUE(found["coupling"]["residual_at_acceptance_max"].is_null());
  EXPECT_TRUE(found["quantities"]["frequency"]["value"].is_null());
}

TEST(Summary, MendsTextThatIsNotUtf8) {
  Summary summary;
  summary.scene = "folder-\xff/scene.txtpb";
  EXPECT_EQ(written(summary)["scene"], "folder-\xEF\xBF\xBD/scene.txtpb");
}

}  // namespace
}  // namespace couplet::store
