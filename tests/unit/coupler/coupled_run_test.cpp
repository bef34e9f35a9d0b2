#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "coupler/scheme/coupled_run.hpp"
#include "proto/participant/remote_participant.hpp"
#include "proto/participant/serve_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/table_file.hpp"
#include "proto/wire/memory_channel.hpp"
#include "proto/wire/zeromq_channel.hpp"
#include "tests/oracle/elastic_tube_participants.hpp"
#include "tests/oracle/piston.hpp"

namespace couplet::coupling {
namespace {

using oracle::PistonFlow;
using oracle::PistonSolid;
using oracle::TimeRule;
using participant::Participant;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

nlohmann::json summary_of(const fs::path& folder) {
  return nlohmann::json::parse(text_of(folder / "summary.json"));
}

v1::Scene piston_scene() {
  v1::Scene scene;
  scene.set_title("pistons");
  scene.mutable_time()->set_end(2);
  scene.mutable_time()->set_step(0.1);
  auto* criterion = scene.mutable_coupling()->add_convergence();
  criterion->set_field("displacement");
  criterion->set_relative(1e-6);
  auto* probe = scene.mutable_output()->add_probe();
  probe->set_name("tip");
  probe->mutable_at()->mutable_position()->set_x(2.1);
  scene.mutable_output()->mutable_checkpoints()->set_every_steps(5);
  return scene;
}

/// Four pistons of different added mass: the accelerations have something to learn.
oracle::PistonRow four_pistons() {
  oracle::PistonRow row;
  row.solid_mass = row.stiffness = row.velocity = Eigen::VectorXd::Ones(4);
  row.added_mass = Eigen::Vector4d(0.1, 1, 5, 20);
  return row;
}

class CoupledRun : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("couplet-" + std::to_string(getpid()) + "-" + test->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  CoupledRunOptions options(const std::string& name) const {
    CoupledRunOptions options;
    options.scene_path = "pistons.txtpb";
    options.run_folder = folder_ / name;
    options.quiet = true;
    return options;
  }

  store::Summary run_pistons(const v1::Scene& scene, const CoupledRunOptions& options, double lightness = 1) const {
    oracle::PistonRow row = four_pistons();
    row.added_mass *= lightness;
    PistonFlow flow(row, TimeRule::trapezoidal);
    PistonSolid solid(row, TimeRule::trapezoidal);
    return run_coupled(flow, solid, scene, options);
  }

  fs::path folder_;
};

TEST_F(CoupledRun, WritesOneRowOfHistoryForEveryStep) {
  run_pistons(piston_scene(), options("a"));
  const store::Table history = store::read_table(folder_ / "a" / "history.csv");
  EXPECT_EQ(history.n_rows(), 20u);
  std::vector<std::string> names;
  for (const store::Column& column : history.columns) names.push_back(column.name + " [" + column.unit + "]");
  EXPECT_THAT(names, testing::ElementsAre("time [s]", "dt [s]", "iterations [1]", "displacement.change [m]",
                                          "displacement.relative_change [1]", "tip.x [m]", "tip.y [m]", "tip.z [m]",
                                          "largest_force [N]", "energy [J]"));
  EXPECT_EQ(history.values[0].back(), 2);
  // The probe follows the third piston: x = 2.1 is nearest to node 2. Second order: (0.1 / 2.4)^2 / 12 of the amplitude
  // a period.
  const double exact = four_pistons().exact_displacement(2)(2);
  EXPECT_NEAR(history.values[history.find("tip.y")].back(), exact, 1e-3 * exact);
}

TEST_F(CoupledRun, WritesOneRowForEveryIteration) {
  const store::Summary summary = run_pistons(piston_scene(), options("a"));
  const store::Table iterations = store::read_table(folder_ / "a" / "iterations.csv");
  EXPECT_DOUBLE_EQ(static_cast<double>(iterations.n_rows()), summary.iterations_mean * 20);
  EXPECT_LE(iterations.values[iterations.find("displacement.relative_change")].back(), 1e-6);
}

TEST_F(CoupledRun, HasNoTableOfIterationsWhenNothingIsIterated) {
  v1::Scene scene = piston_scene();
  scene.mutable_coupling()->Clear();
  scene.mutable_coupling()->set_scheme(v1::Coupling::EXPLICIT);
  PistonFlow flow(oracle::one_piston(0.01), TimeRule::backward);
  PistonSolid solid(oracle::one_piston(0.01), TimeRule::backward);
  run_coupled(flow, solid, scene, options("a"));
  EXPECT_FALSE(fs::exists(folder_ / "a" / "iterations.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "a" / "history.csv"));
}

TEST_F(CoupledRun, SaysInTheSummaryWhatItWas) {
  run_pistons(piston_scene(), options("a"));
  const nlohmann::json summary = summary_of(folder_ / "a");
  EXPECT_EQ(summary["status"], "finished");
  EXPECT_EQ(summary["steps"], 20);
  EXPECT_EQ(summary["end_time"], 2);
  EXPECT_LE(summary["coupling"]["residual_at_acceptance_max"], 1e-6);
  EXPECT_EQ(summary["conservation"]["force_error_max"], 0);  // the same nodes on both sides
  EXPECT_TRUE(summary["programs"].contains("coupler"));
  EXPECT_THAT(text_of(folder_ / "a" / "resolved_scene.txtpb"), HasSubstr("SERIAL_IMPLICIT"));
}

TEST_F(CoupledRun, EndsAfterTheStepsThatWereAskedFor) {
  CoupledRunOptions some = options("a");
  some.steps = 7;
  EXPECT_EQ(run_pistons(piston_scene(), some).steps, 7);
  EXPECT_EQ(summary_of(folder_ / "a")["status"], "finished");
}

TEST_F(CoupledRun, StopsInGoodOrderWhenAsked) {
  CoupledRunOptions stopped = options("a");
  int n_asked = 0;
  stopped.should_stop = [&n_asked] { return ++n_asked > 8; };
  run_pistons(piston_scene(), stopped);
  EXPECT_EQ(summary_of(folder_ / "a")["status"], "stopped");
  EXPECT_EQ(store::read_table(folder_ / "a" / "history.csv").n_rows(), 8u);
  EXPECT_TRUE(fs::exists(folder_ / "a" / "checkpoint" / "step-0000000008"));  // where it can be continued
}

TEST_F(CoupledRun, ResumesWithEqualBits) {
  using Scheme = v1::Coupling;
  for (const auto scheme : {Scheme::SERIAL_IMPLICIT, Scheme::PARALLEL_IMPLICIT}) {
    for (const int acceleration : {0, 1, 2, 3}) {
      v1::Scene scene = piston_scene();
      scene.mutable_coupling()->set_scheme(scheme);
      scene.mutable_coupling()->set_iterations_max(500);
      if (acceleration == 1) scene.mutable_coupling()->mutable_aitken();
      if (acceleration == 2) scene.mutable_coupling()->mutable_iqn_imvj();
      if (acceleration == 3) {
        auto* constant = scene.mutable_coupling()->mutable_constant();
        constant->set_force(0.05), constant->set_displacement(0.06), constant->set_velocity(0.07);
        scene.mutable_coupling()->mutable_convergence(0)->set_relative(1e-3);
      }
      // Relaxation alone does not bring strong added mass to converge when both solve at the same time.
      const double lightness = scheme == Scheme::PARALLEL_IMPLICIT ? 0.02 : 1;
      const std::string name = std::to_string(scheme) + "-" + std::to_string(acceleration);
      run_pistons(scene, options(name + "-straight"), lightness);
      CoupledRunOptions part = options(name + "-parts");
      part.steps = 13;  // three steps behind the checkpoint at 10: their rows are cut
      run_pistons(scene, part, lightness);
      part.steps = 0;
      part.resume_from = part.run_folder;
      run_pistons(scene, part, lightness);
      for (const char* file : {"history.csv", "iterations.csv"}) {
        EXPECT_EQ(text_of(folder_ / (name + "-straight") / file), text_of(folder_ / (name + "-parts") / file)) << name;
      }
      nlohmann::json a = summary_of(folder_ / (name + "-straight")), b = summary_of(folder_ / (name + "-parts"));
      EXPECT_EQ(a["coupling"], b["coupling"]);
    }
  }
}

TEST_F(CoupledRun, ResumesIntoAnotherFolderWithTheWholeHistory) {
  run_pistons(piston_scene(), options("straight"));
  CoupledRunOptions part = options("first");
  part.steps = 10;
  run_pistons(piston_scene(), part);
  CoupledRunOptions rest = options("second");
  rest.resume_from = folder_ / "first" / "checkpoint" / "step-0000000005";
  run_pistons(piston_scene(), rest);
  EXPECT_EQ(text_of(folder_ / "straight" / "history.csv"), text_of(folder_ / "second" / "history.csv"));
}

TEST_F(CoupledRun, ResumesAnExplicitRunWithEqualBits) {
  v1::Scene scene = piston_scene();
  scene.mutable_coupling()->Clear();
  scene.mutable_coupling()->set_scheme(v1::Coupling::EXPLICIT);
  const auto run = [&](CoupledRunOptions its_options) {
    PistonFlow flow(oracle::one_piston(0.01), TimeRule::backward);
    PistonSolid solid(oracle::one_piston(0.01), TimeRule::backward);
    run_coupled(flow, solid, scene, its_options);
  };
  run(options("straight"));
  CoupledRunOptions part = options("parts");
  part.steps = 5;
  run(part);
  part.steps = 0;
  part.resume_from = part.run_folder;
  run(part);
  EXPECT_EQ(text_of(folder_ / "straight" / "history.csv"), text_of(folder_ / "parts" / "history.csv"));
}

/// Fails as told at one step.
template <class Failure>
class FailingSolid : public PistonSolid {
 public:
  using PistonSolid::PistonSolid;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override {
    if (interval.step == 4) throw Failure("the solid", "has had enough");
    return PistonSolid::solve_step(interval, fields);
  }
  std::vector<participant::NamedNumber> close(const std::string& reason) override {
    reason_ = reason;
    return {{"seconds", 1, "s"}, {"peak_memory_bytes", 2, "1"}};
  }
  std::string reason_;
};

template <class Failure>
void expect_orderly_end(const CoupledRunOptions& options) {
  PistonFlow flow(four_pistons(), TimeRule::trapezoidal);
  FailingSolid<Failure> solid(four_pistons(), TimeRule::trapezoidal);
  EXPECT_THROW(run_coupled(flow, solid, piston_scene(), options), Failure);
  EXPECT_EQ(store::read_table(options.run_folder / "history.csv").n_rows(), 3u);
  const nlohmann::json summary = summary_of(options.run_folder);
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_THAT(summary["failure"].get<std::string>(), HasSubstr("has had enough"));
  EXPECT_EQ(summary["steps"], 3);
  EXPECT_THAT(solid.reason_, HasSubstr("has had enough"));
}

TEST_F(CoupledRun, EndsOrderlyWhenASolverFails) {
  expect_orderly_end<report::NumericsError>(options("a"));
}
TEST_F(CoupledRun, EndsOrderlyWhenAPeerIsLost) {
  expect_orderly_end<report::PeerError>(options("a"));
}
TEST_F(CoupledRun, EndsOrderlyWhenTheDiskIsFull) {
  expect_orderly_end<report::FileError>(options("a"));
}

/// Runs with both participants behind channels, each served by a thread of its own.
using ChannelPair = std::pair<std::unique_ptr<wire::Channel>, std::unique_ptr<wire::Channel>>;

void run_over(ChannelPair for_flow, ChannelPair for_solid, const v1::Scene& scene, const CoupledRunOptions& options) {
  const auto serve = [](wire::Channel& channel, Participant& participant) {
    participant::serve_participant(channel, participant, {"oracle", 1, 1, "", {}});
  };
  PistonFlow flow(four_pistons(), TimeRule::trapezoidal);
  PistonSolid solid(four_pistons(), TimeRule::trapezoidal);
  std::thread flow_thread([&] { serve(*for_flow.second, flow); });
  std::thread solid_thread([&] { serve(*for_solid.second, solid); });
  {
    participant::RemoteParticipant remote_flow(std::move(for_flow.first), {.name = "flow", .run = "test"});
    participant::RemoteParticipant remote_solid(std::move(for_solid.first), {.name = "solid", .run = "test"});
    run_coupled(remote_flow, remote_solid, scene, options);
  }
  flow_thread.join();
  solid_thread.join();
}

ChannelPair make_zeromq_pair() {
  auto server = wire::listen_zeromq("tcp://127.0.0.1:*", {});
  auto client = wire::connect_zeromq(server->describe(), {});
  return {std::move(client), std::move(server)};
}

TEST_F(CoupledRun, GivesEqualBitsOverEveryChannel) {
  for (const auto scheme : {v1::Coupling::SERIAL_IMPLICIT, v1::Coupling::PARALLEL_IMPLICIT}) {
    v1::Scene scene = piston_scene();
    scene.mutable_coupling()->set_scheme(scheme);
    const std::string name = std::to_string(scheme);
    run_pistons(scene, options(name + "direct"));
    run_over(wire::make_memory_channel(), wire::make_memory_channel(), scene, options(name + "memory"));
    run_over(make_zeromq_pair(), make_zeromq_pair(), scene, options(name + "zeromq"));
    for (const char* file : {"history.csv", "iterations.csv"}) {
      const std::string direct = text_of(folder_ / (name + "direct") / file);
      EXPECT_EQ(direct, text_of(folder_ / (name + "memory") / file));
      EXPECT_EQ(direct, text_of(folder_ / (name + "zeromq") / file));
    }
  }
}

/// The solver's NumericsError crosses the channel and the step is tried again.
class GivingUpOnce : public PistonSolid {
 public:
  using PistonSolid::PistonSolid;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override {
    if (interval.step == 4 && interval.duration > 0.06) throw report::NumericsError("element 7", "is inverted");
    return PistonSolid::solve_step(interval, fields);
  }
};

TEST_F(CoupledRun, RetriesWhenARemoteSolverGivesUp) {
  for (const auto scheme : {v1::Coupling::SERIAL_IMPLICIT, v1::Coupling::PARALLEL_IMPLICIT}) {
    v1::Scene scene = piston_scene();
    scene.mutable_coupling()->set_scheme(scheme);
    PistonFlow flow(four_pistons(), TimeRule::trapezoidal);
    GivingUpOnce solid(four_pistons(), TimeRule::trapezoidal);
    auto [client, server] = wire::make_memory_channel();
    std::thread thread([&solid, channel = server.get()] {
      participant::serve_participant(*channel, solid, {"oracle", 1, 1, "", {}});
    });
    participant::RemoteParticipant remote(std::move(client), {.name = "solid", .run = "test"});
    const store::Summary summary = run_coupled(flow, remote, scene, options(std::to_string(scheme)));
    thread.join();
    EXPECT_EQ(summary.status, "finished");
    EXPECT_GT(summary.steps, 20);
    EXPECT_THAT(text_of(folder_ / std::to_string(scheme) / "log.txt"), HasSubstr("element 7: is inverted"));
  }
}

}  // namespace
}  // namespace couplet::coupling
