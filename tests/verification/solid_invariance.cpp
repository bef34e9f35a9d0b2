// Whatever the method, equal questions get equal bits: on any number of threads, when a step is solved again, and when
// a run is resumed from a checkpoint, also in the middle of contact and of a prescribed motion.

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "proto/report/failure.hpp"
#include "solid-server/service/make_setup.hpp"
#include "solid-server/service/solid_checkpoint.hpp"

namespace couplet::solid {
namespace {

constexpr int n_steps = 8;

struct Case {
  std::string name;
  std::string solid;
  double step;  // [s]
  bool touches = false;
};

// A block on another one: 24 and 12 elements, so that three threads share packs, chunks and nodes.
const std::string rubber = "material { density: 1000 mooney_rivlin { a10: 2000 a01: 300 bulk_modulus: 4e4 } } ";
const std::string one_block =
    "body { name: \"block\" box { length { x: 0.03 y: 0.01 z: 0.02 } elements_x: 3 elements_y: 2 elements_z: 4 } " +
    rubber +
    "fixed: \"x_min\" mass_damping: 5 stiffness_damping: 1e-6 } "
    "pressure { surface: \"y_max\" value { row { time: 0 value: 0 } row { time: 1e-3 value: 400 } } } ";
const std::string kick = "kick { time: 3e-4 velocity { y: \"0.05*sin(pi*z/0.02)\" } } ";
const std::string two_blocks = R"(
  body { name: "lower" box { length { x: 0.03 y: 0.01 z: 0.02 } elements_x: 3 elements_y: 2 elements_z: 4 } )" +
                               rubber + R"( fixed: "y_min" mass_damping: 20 }
  body { name: "upper" ball { radius: 0.008 centre { x: 0.015 y: 0.01805 z: 0.01 } part: LOWER_HALF elements: 1 } )" +
                               rubber + R"( mass_damping: 20 }
  prescribed_motion { nodes: "upper/cut" x: "0.2*t" y: "-0.15*t" z: "0" }
  contact { first: "lower/y_max" second: "upper/surface" distance: 1e-4 })";

const std::vector<Case> cases = {
    {"CentralDifference", one_block + kick, 1e-4},
    {"GeneralizedAlpha", one_block + kick + "time_integration { method: GENERALIZED_ALPHA }", 1e-4},
    {"Static", one_block + "time_integration { method: STATIC }", 1e-4},
    {"CentralDifferenceInContact", two_blocks, 4e-4, true},
    {"GeneralizedAlphaInContact", two_blocks + "time_integration { method: GENERALIZED_ALPHA }", 4e-4, true},
    {"StaticInContact", two_blocks + "time_integration { method: STATIC }", 4e-4, true},
};

SolidModel make_model(const Case& c, int n_threads = 1) {
  v1::Solid solid;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(c.solid, &solid));
  SolidSetup setup = make_setup(solid, ".");
  setup.n_threads = n_threads;
  return SolidModel(std::move(setup));
}

void solve(SolidModel& model, double duration) {
  model.solve_step(duration, surface::NodeArray::Zero(0, 3));
}

void expect_equal(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.force, b.force);
}

class InvarianceOf : public testing::TestWithParam<Case> {};

TEST_P(InvarianceOf, TheNumberOfThreads) {
  SolidModel one = make_model(GetParam()), two = make_model(GetParam(), 2), three = make_model(GetParam(), 3);
  for (int n = 0; n < n_steps; ++n) {
    for (SolidModel* model : {&one, &two, &three}) {
      solve(*model, GetParam().step);
      model->accept_step();
    }
    for (const SolidModel* model : {&two, &three}) {
      expect_equal(one.accepted().motion, model->accepted().motion);
      EXPECT_EQ(one.energy().strain, model->energy().strain);
      EXPECT_EQ(one.energy().contact, model->energy().contact);
    }
    ASSERT_FALSE(HasFailure()) << "step " << n + 1;
  }
  EXPECT_EQ(one.energy().contact > 0, GetParam().touches);
  EXPECT_GT(one.accepted().motion.displacement.cwiseAbs().maxCoeff(), 1e-5);  // [m]: something has moved
}

TEST_P(InvarianceOf, AStepThatIsSolvedAgain) {
  SolidModel model = make_model(GetParam());
  for (int n = 0; n < n_steps; ++n) {
    solve(model, GetParam().step);
    const Motion first = model.trial().motion;
    solve(model, 0.7 * GetParam().step);
    solve(model, GetParam().step);
    expect_equal(first, model.trial().motion);
    model.accept_step();
    ASSERT_FALSE(HasFailure()) << "step " << n + 1;
  }
}

TEST_P(InvarianceOf, AResume) {
  const std::string path = testing::TempDir() + "couplet_solid_invariance_" + GetParam().name + ".h5";
  SolidModel through = make_model(GetParam());
  for (int n = 0; n < n_steps; ++n) {
    if (n >= n_steps / 2) {
      EXPECT_EQ(through.energy().contact > 0, GetParam().touches);  // in the middle of it
      write_checkpoint(path, through.accepted(), {});
      SolidModel resumed = make_model(GetParam());
      resumed.resume(read_checkpoint(path, resumed.accepted(), {}).state);
      solve(resumed, GetParam().step);
      solve(through, GetParam().step);
      expect_equal(through.trial().motion, resumed.trial().motion);
      ASSERT_FALSE(HasFailure()) << "step " << n + 1;
    } else {
      solve(through, GetParam().step);
    }
    through.accept_step();
  }
  std::filesystem::remove(path);
}

TEST_P(InvarianceOf, ARefusedCheckpointOfAnotherMesh) {
  const std::string path = testing::TempDir() + "couplet_solid_other_mesh_" + GetParam().name + ".h5";
  write_checkpoint(path, make_model(GetParam()).accepted(), {});
  Case other = GetParam();
  other.solid.replace(other.solid.find("elements_z: 4"), 13, "elements_z: 5");
  const SolidModel model = make_model(other);
  try {
    read_checkpoint(path, model.accepted(), {});
    FAIL();
  } catch (const report::FileError& error) {
    EXPECT_NE(std::string(error.what()).find("nodes, but the body has"), std::string::npos) << error.what();
  }
  std::filesystem::remove(path);
}

INSTANTIATE_TEST_SUITE_P(Methods, InvarianceOf, testing::ValuesIn(cases), [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace couplet::solid
