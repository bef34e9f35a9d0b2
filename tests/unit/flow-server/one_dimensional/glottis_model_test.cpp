#include "flow-server/one_dimensional/glottis_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <limits>
#include <numbers>

#include "proto/report/failure.hpp"
#include "tests/unit/flow-server/extruded_fold.hpp"
#include "tests/unit/flow-server/one_dimensional/every_glottal_model.hpp"

namespace couplet::flow {
namespace {

using ::testing::HasSubstr;

using std::numbers::pi;

GlottisOptions options_of(GlottalModel model) {
  GlottisOptions options;
  options.law = {.model = model, .density = 1.13, .viscosity = 2.27e-4};
  if (model == GlottalModel::m1 || model == GlottalModel::m2) {
    options.law.friction_coefficient = 2;
    options.law.smallest_recovery = 0.5;
  }
  if (model == GlottalModel::m2) options.law.entrance_contraction = 0.25;
  options.subglottal_pressure = [](double t) { return 1000 * std::min(1.0, t / 1e-3); };
  options.exit_pressure = -100;
  options.largest_driving_pressure = 1100;
  return options;
}

/// The fold from z = 0 to `share` of its length of 20 mm; its material lines are marked at mid length.
FoldOptions fold(double share) {
  const int n_rows = static_cast<int>(std::lround(12 * share));
  const ExtrudedFold shape{
      .outline = fold_outline, .n_across = 12, .n_rows = n_rows, .z_low = 0, .z_high = 0.02 * share};
  FoldOptions options;
  options.surface = make_surface(shape);
  options.gap = {0.0102, 2e-4, share < 1};
  options.lines = {node_number(shape, 14, 12), node_number(shape, 6, 12)};
  return options;
}

/// A motion from rest that opens and tilts the glottis, symmetric to mid length.
surface::FieldSet motion_of(const surface::SurfaceMesh& mesh, double t) {
  surface::NodeArray u = surface::NodeArray::Zero(mesh.n_nodes(), 3);
  for (std::int64_t i = 0; i < mesh.n_nodes(); ++i) {
    const double x = mesh.node_position(i, 0), y = mesh.node_position(i, 1), z = mesh.node_position(i, 2);
    const double shape = y * y / 1e-4 * std::sin(pi * z / 0.02);
    u(i, 0) = 4e-4 * shape * std::sin(2 * pi * 140 * t);
    const double phase = 200 * (x - 0.01);
    u(i, 1) = -2e-4 * shape * (std::cos(phase) - std::cos(2 * pi * 140 * t + phase));
    u(i, 2) = 1e-4 * shape * std::sin(2 * pi * z / 0.02) * std::sin(2 * pi * 140 * t);
  }
  return {{"displacement", "m", u}};
}

std::filesystem::path scratch_folder() {
  const auto folder = std::filesystem::temp_directory_path() / ("couplet-glottis-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  return folder;
}

double value_of(const std::vector<FlowQuantity>& quantities, const std::string& name) {
  for (const auto& quantity : quantities) {
    if (quantity.name == name) return quantity.value;
  }
  ADD_FAILURE() << name << " is missing";
  return 0;
}

class GlottisModelOf : public ::testing::TestWithParam<GlottalModel> {};

TEST_P(GlottisModelOf, HalfAFoldGivesTheFlowOfTheWholeAndHalfItsForce) {
  GlottisModel whole(options_of(GetParam()), fold(1)), half(options_of(GetParam()), fold(0.5));
  for (int step = 1; step <= 40; ++step) {
    const double t = step * 5e-5;
    whole.solve_step(5e-5, motion_of(whole.interface(), t));
    half.solve_step(5e-5, motion_of(half.interface(), t));
    const auto a = whole.accept_step(), b = half.accept_step();
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(a[i].name, b[i].name);
      // Equal sums in another order, with dVol/dt in between.
      EXPECT_NEAR(a[i].value, b[i].value, 1e-9 * std::abs(a[i].value) + 1e-15) << a[i].name << " step " << step;
    }
    const double size = whole.force().cwiseAbs().sum();
    for (int c = 0; c < 2; ++c) EXPECT_NEAR(whole.force().col(c).sum(), 2 * half.force().col(c).sum(), 1e-9 * size);
    EXPECT_NEAR(whole.force().col(2).sum(), 0, 1e-9 * size);
  }
}

TEST_P(GlottisModelOf, SolvingAStepAgainGivesEqualBits) {
  GlottisModel model(options_of(GetParam()), fold(0.5));
  for (int step = 1; step <= 3; ++step) {
    const auto motion = motion_of(model.interface(), step * 1e-5);
    model.solve_step(1e-5, motion);
    const surface::NodeArray first = model.force();
    model.solve_step(4e-5, motion_of(model.interface(), 1e-3));
    EXPECT_NE(first, model.force());
    model.solve_step(1e-5, motion);
    EXPECT_EQ(first, model.force());
    model.accept_step();
  }
}

TEST_P(GlottisModelOf, ContinuesFromACheckpointWithEqualBits) {
  const auto path = scratch_folder() / "flow.h5";
  GlottisModel model(options_of(GetParam()), fold(0.5));
  const auto advance = [](GlottisModel& m, int step) {
    m.solve_step(2e-5, motion_of(m.interface(), step * 2e-5));
    return m.accept_step();
  };
  for (int step = 1; step <= 5; ++step) advance(model, step);
  model.write_checkpoint(path);
  GlottisModel resumed(options_of(GetParam()), fold(0.5));
  resumed.resume(path);
  EXPECT_EQ(resumed.time(), model.time());
  EXPECT_EQ(resumed.force(), model.force());
  for (int step = 6; step <= 10; ++step) {
    const auto a = advance(model, step), b = advance(resumed, step);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value) << a[i].name;
    EXPECT_EQ(model.force(), resumed.force());
  }
  std::filesystem::remove_all(path.parent_path());
}

TEST_P(GlottisModelOf, PressureFarUpstreamPushesTheFoldDownstreamAndAside) {
  GlottisModel model(options_of(GetParam()), fold(0.5));
  for (int step = 1; step <= 100; ++step) {
    model.solve_step(2e-5, motion_of(model.interface(), 0));
    model.accept_step();
  }
  EXPECT_GT(model.force().col(0).sum(), 0);
  EXPECT_LT(model.force().col(1).sum(), 0);
}

TEST_P(GlottisModelOf, AClosedGlottisLeaksThroughItsSmallestGapAndStaysFinite) {
  GlottisModel model(options_of(GetParam()), fold(0.5));
  surface::FieldSet motion = motion_of(model.interface(), 0);
  double rate = 0;
  for (int step = 1; step <= 400; ++step) {  // shut within 2 ms, which is half a period of vibration
    for (std::int64_t i = 0; i < model.interface().n_nodes(); ++i) {
      const double y = model.interface().node_position(i, 1) / 0.01;
      motion[0].values(i, 0) = motion[0].values(i, 2) = 0;
      motion[0].values(i, 1) = 6e-4 * std::min(step / 200.0, 1.0) * y * y;
    }
    model.solve_step(1e-5, motion);
    rate = value_of(model.accept_step(), "flow.rate");
  }
  EXPECT_TRUE(model.force().allFinite());
  EXPECT_GT(rate, 0);
  EXPECT_LT(rate, 0.02 * 2e-4 * std::sqrt(2 * 1100 / 1.13) * 1.5);
}

INSTANTIATE_TEST_SUITE_P(Models, GlottisModelOf, every_model, name_of_model);

std::string divergence_of(GlottisModel& model, const surface::FieldSet& motion) {
  try {
    model.solve_step(1e-5, motion);
    model.accept_step();
  } catch (const report::NumericsError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(GlottisModel, RefusesADisplacementThatIsNotANumber) {
  GlottisModel model(options_of(GlottalModel::m2), fold(0.5));
  surface::FieldSet motion = motion_of(model.interface(), 0);
  motion[0].values(7, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(divergence_of(model, motion), HasSubstr("the displacement of the fold is not a number"));
}

TEST(GlottisModel, RefusesAFoldThatHasFlownOff) {
  GlottisModel model(options_of(GlottalModel::m2), fold(0.5));
  surface::FieldSet motion = motion_of(model.interface(), 0);
  motion[0].values.col(0).array() = 0.05;
  EXPECT_THAT(divergence_of(model, motion), HasSubstr("the exit line is"));
}

TEST(GlottisModel, SaysThatB2HasNoEquilibriumWhenItsThroatIsSuckedShut) {
  GlottisModel model(options_of(GlottalModel::b2), fold(0.5));
  surface::FieldSet motion = motion_of(model.interface(), 0);
  for (std::int64_t i = 0; i < model.interface().n_nodes(); ++i) {  // the throat closes, the exit opens wide
    const double x = model.interface().node_position(i, 0);
    motion[0].values.row(i) << 0, (x > 0.0118 ? -4e-3 : x > 0.0095 ? 2e-4 : 0.0), 0;
  }
  std::string found = "accepted";
  for (int step = 0; step < 400 && found == "accepted"; ++step) found = divergence_of(model, motion);
  EXPECT_THAT(found, HasSubstr("model B2 has no equilibrium once the exit is wider than the throat"));
  EXPECT_THAT(found, HasSubstr("use M2"));
}

TEST(GlottisModel, RefusesTheCheckpointOfAnotherScene) {
  const auto path = scratch_folder() / "flow.h5";
  GlottisOptions coarse = options_of(GlottalModel::m2);
  coarse.n_stations = 50;
  GlottisModel(coarse, fold(0.5)).write_checkpoint(path);
  GlottisModel model(options_of(GlottalModel::m2), fold(0.5));
  EXPECT_THROW(model.resume(path), report::FileError);
  std::filesystem::remove_all(path.parent_path());
}

TEST(GlottisModel, APrescribedChannelNeedsNoMotionAndGivesNoForce) {
  PrescribedChannel::Shape shape{.length = 0.01, .width = 0.02, .height = [](double x, double t) {
                                   return 1e-3 + 0.2 * (x - 0.008) * (x - 0.008) / 0.008 + 1e-4 * std::sin(600 * t);
                                 }};
  GlottisModel model(options_of(GlottalModel::m1), shape);
  EXPECT_TRUE(model.needs().empty());
  EXPECT_EQ(model.interface().n_nodes(), 0);
  model.solve_step(1e-5, {});
  const auto quantities = model.accept_step();
  EXPECT_GT(value_of(quantities, "flow.rate"), 0);
  const auto path = scratch_folder() / "channel.h5";
  model.write_checkpoint(path);
  GlottisModel resumed(options_of(GlottalModel::m1), shape);
  resumed.resume(path);
  model.solve_step(1e-5, {});
  resumed.solve_step(1e-5, {});
  EXPECT_EQ(value_of(model.accept_step(), "flow.rate"), value_of(resumed.accept_step(), "flow.rate"));
  std::filesystem::remove_all(path.parent_path());
}

TEST(GlottisModel, RefusesAChannelThatCloses) {
  PrescribedChannel::Shape shape{
      .length = 0.01, .width = 0.02, .height = [](double x, double) { return 1e-3 - 0.2 * x; }};
  EXPECT_THROW(GlottisModel(options_of(GlottalModel::m1), shape), report::NumericsError);
}

}  // namespace
}  // namespace couplet::flow
