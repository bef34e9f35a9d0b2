#include "proto/participant/run_alone.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "proto/report/failure.hpp"
#include "proto/store/hdf5_file.hpp"
#include "proto/store/table_file.hpp"

namespace couplet::participant {
namespace {

constexpr double frequency = 50;  // [Hz]

/// One node on a circle: displacement x = cos, y = sin of the angle, which is turned step by step so that round-off
/// differs with every path through the steps.
class CirclingPoint : public Participant {
 public:
  std::function<void(std::int64_t)> before_step = [](std::int64_t) {};
  std::function<bool(double)> goes_on;
  std::string closed_for;
  surface::FieldSet load;

  Opened open(const OpenRequest& request) override {
    x_ = 1;
    y_ = 0;
    double time = 0;
    if (!request.resume_from.empty()) {
      const auto file = store::Hdf5File::open_for_reading(request.resume_from);
      x_ = file.read_number("x");
      y_ = file.read_number("y");
      time = file.read_number("time");
    }
    time_ = time;
    surface::SurfaceMesh mesh;
    mesh.node_position = surface::NodeArray::Zero(1, 3);
    mesh.marker = {{"B1", 0}};
    return {mesh, time, {"force"}, {"displacement"}, {displacement()}};
  }

  void watch_steps(std::function<bool(double)> watch) override { goes_on = std::move(watch); }

  StepSolved solve_step(const StepInterval& interval, const surface::FieldSet& fields) override {
    before_step(interval.step);
    load = fields;
    trial_duration_ = interval.duration;
    EXPECT_EQ(interval.start, time_);
    return {{moved(interval.duration)}, 0.0, 3, 0.0};
  }

  std::vector<NamedNumber> accept_step(std::int64_t) override {
    const auto field = moved(trial_duration_);
    x_ = field.values(0, 0);
    y_ = field.values(0, 1);
    time_ += trial_duration_;
    return {{"radius", std::hypot(x_, y_), "m"}};
  }

  std::uint64_t write_checkpoint(const std::string& path) override {
    auto file = store::Hdf5File::create(path);
    file.write_number("x", x_);
    file.write_number("y", y_);
    file.write_number("time", time_);
    file.close();
    return 1;
  }

  std::vector<NamedNumber> close(const std::string& reason) override {
    closed_for = reason;
    return {{"seconds", 1.5, "s"}, {"peak_memory_bytes", 1e6, "1"}, {"substeps", 7, "1"}};
  }

 private:
  surface::Field moved(double duration) const {
    const double angle = 2 * std::numbers::pi * frequency * duration;
    const double x = std::cos(angle) * x_ - std::sin(angle) * y_, y = std::sin(angle) * x_ + std::cos(angle) * y_;
    return {"displacement", "m", (surface::NodeArray(1, 3) << x, y, 0).finished()};
  }
  surface::Field displacement() const { return moved(0); }

  double x_ = 1, y_ = 0, time_ = 0, trial_duration_ = 0;
};

class RunAlone : public testing::Test {
 protected:
  RunAlone() {
    std::filesystem::remove_all(folder_);
    scene_ = scene(
        "title: 'a circling point' time { end: 0.2 step: 0.0007 }"
        "output { probe { name: 'B1' at { marker: 'B1' } } checkpoints { every_steps: 40 }"
        "  quantity { name: 'frequency' kind: FREQUENCY column: 'B1.x' }"
        "  quantity { name: 'lead' kind: PHASE_DELAY column: 'B1.x' reference: 'B1.y' }"
        "  quantity { name: 'nonsense' kind: MAXIMUM column: 'radius' } }");
    options_.program = "solid-server";
    options_.scene_path = "scene.txtpb";
    options_.run_folder = folder_ / "run";
    options_.quiet = true;
  }
  ~RunAlone() override { std::filesystem::remove_all(folder_); }

  static v1::Scene scene(const std::string& text) {
    v1::Scene message;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message));
    return message;
  }
  static std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  nlohmann::json summary(const std::string& run) const {
    return nlohmann::json::parse(text_of(folder_ / run / "summary.json"));
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("couplet-run-alone-" + std::to_string(getpid()));
  v1::Scene scene_;
  AloneOptions options_;
  CirclingPoint point_;
};

TEST_F(RunAlone, LeavesTheFilesOfARun) {
  run_alone(point_, scene_, options_);
  const auto found = summary("run");
  EXPECT_EQ(found["status"], "finished");
  EXPECT_EQ(found["steps"], 286);
  EXPECT_EQ(found["end_time"], 0.2);
  EXPECT_EQ(found["programs"]["solid-server"]["seconds"], 1.5);
  EXPECT_EQ(found["programs"]["solid-server"]["substeps"], 7);
  EXPECT_FALSE(found.contains("coupling"));
  EXPECT_NEAR(found["quantities"]["frequency"]["value"], frequency, 5e-4 * frequency);
  EXPECT_NEAR(found["quantities"]["lead"]["value"], 90, 0.5) << "cosine leads sine";
  EXPECT_FALSE(found["quantities"].contains("nonsense")) << "a constant has no cycles; the run ends well without it";
  EXPECT_EQ(point_.closed_for, "finished");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run" / "resolved_scene.txtpb"));
  const auto history = store::read_table(folder_ / "run" / "history.csv");
  EXPECT_EQ(history.n_rows(), 286U);
  EXPECT_EQ(history.columns[0].name, "time");
  EXPECT_NO_THROW(history.find("B1.z"));
  EXPECT_NO_THROW(history.find("radius"));
}

TEST_F(RunAlone, EndsExactlyAtTheEndByAShorterLastStep) {
  run_alone(point_, scene_, options_);
  const auto history = store::read_table(folder_ / "run" / "history.csv");
  EXPECT_EQ(history.values[0].back(), 0.2);
  const auto& dt = history.values[history.find("dt")];
  EXPECT_EQ(dt.front(), 0.0007);
  EXPECT_NEAR(dt.back(), 0.2 - 285 * 0.0007, 1e-12);
}

TEST_F(RunAlone, TakesNoSliverOfAStepAtTheEnd) {
  // 1000 sums of 1e-4 miss 0.1 by some units of the last place.
  run_alone(point_, scene("title: 'x' time { end: 0.1 step: 1e-4 }"), options_);
  EXPECT_EQ(summary("run")["steps"], 1000);
  EXPECT_EQ(summary("run")["end_time"], 0.1);
}

TEST_F(RunAlone, GivesFieldsOfZerosForWhatIsNeeded) {
  run_alone(point_, scene_, options_);
  ASSERT_EQ(point_.load.size(), 1U);
  EXPECT_EQ(point_.load[0].name, "force");
  EXPECT_EQ(point_.load[0].unit, "N");
  EXPECT_EQ(point_.load[0].values, surface::NodeArray::Zero(1, 3));
}

TEST_F(RunAlone, ResumedRunLeavesTheSameBytes) {
  run_alone(point_, scene_, options_);
  const std::string whole = text_of(folder_ / "run" / "history.csv");
  for (const std::string from : {"run", "run/checkpoint", "run/checkpoint/step-0000000240"}) {
    AloneOptions resumed = options_;
    resumed.run_folder = folder_ / "resumed";
    resumed.resume_from = folder_ / from;
    CirclingPoint other;
    run_alone(other, scene_, resumed);
    EXPECT_EQ(text_of(folder_ / "resumed" / "history.csv"), whole) << from;
    EXPECT_EQ(summary("resumed")["quantities"], summary("run")["quantities"]) << from;
  }
}

TEST_F(RunAlone, ResumesInItsOwnFolderAfterAnEndAnywhere) {
  run_alone(point_, scene_, options_);
  const std::string whole = text_of(folder_ / "run" / "history.csv");
  options_.run_folder = folder_ / "cut";
  options_.steps = 100;
  CirclingPoint first, second;
  run_alone(first, scene_, options_);
  EXPECT_EQ(summary("cut")["status"], "stopped");
  EXPECT_EQ(summary("cut")["steps"], 100);
  options_.steps = 0;
  options_.resume_from = folder_ / "cut";
  run_alone(second, scene_, options_);
  EXPECT_EQ(summary("cut")["status"], "finished");
  EXPECT_EQ(text_of(folder_ / "cut" / "history.csv"), whole);
}

TEST_F(RunAlone, RecordsAFailureAndThrowsItOn) {
  point_.before_step = [](std::int64_t step) {
    if (step == 50) throw report::NumericsError("element 7", "is inverted", "take smaller steps");
  };
  EXPECT_THROW(run_alone(point_, scene_, options_), report::NumericsError);
  const auto found = summary("run");
  EXPECT_EQ(found["status"], "failed");
  EXPECT_EQ(found["failure"], "element 7: is inverted; take smaller steps");
  EXPECT_EQ(found["steps"], 49);
  EXPECT_EQ(point_.closed_for, "failed");
  EXPECT_EQ(store::read_table(folder_ / "run" / "history.csv").n_rows(), 49U);
}

TEST_F(RunAlone, EndsAfterTheStepInWhichASignalComes) {
  // In a process of its own: the mark that a signal leaves stays for the rest of a process.
  const auto interrupted = [&] {
    point_.before_step = [](std::int64_t step) {
      if (step == 60) std::raise(SIGTERM);
    };
    run_alone(point_, scene_, options_);
    std::exit(point_.closed_for == "stopped" ? 7 : 8);
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(7), "");
  EXPECT_EQ(summary("run")["status"], "stopped");
  EXPECT_EQ(summary("run")["steps"], 60);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/checkpoint/step-0000000060/complete")) << "to go on from";
}

TEST_F(RunAlone, EndsInTheMidstOfALongStep) {
  const auto interrupted = [&] {
    point_.before_step = [&](std::int64_t step) {
      if (!point_.goes_on(0)) std::exit(9);  // nobody has asked yet
      if (step == 60) std::raise(SIGTERM);
      if (!point_.goes_on(0)) throw report::Interrupted("step 60");
    };
    run_alone(point_, scene_, options_);
    std::exit(point_.closed_for == "stopped" ? 7 : 8);
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(7), "");
  EXPECT_EQ(summary("run")["status"], "stopped");
  EXPECT_EQ(summary("run")["steps"], 59);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/checkpoint/step-0000000059/complete")) << "to go on from";
}

TEST_F(RunAlone, RefusesToResumeWithOtherColumns) {
  run_alone(point_, scene_, options_);
  scene_.mutable_output()->clear_probe();
  scene_.mutable_output()->clear_quantity();
  options_.resume_from = options_.run_folder;
  options_.run_folder = folder_ / "resumed";
  scene_.mutable_time()->set_end(0.3);
  EXPECT_THROW(run_alone(point_, scene_, options_), report::FileError);
}

}  // namespace
}  // namespace couplet::participant
