#include "solid-server/solid_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/mesh/parametric/vocal_fold_mesh.hpp"

namespace couplet::solid {
namespace {

constexpr double coupling_step = 2e-5;  // [s]

/// A small fold with everything that can act on it: damping that ends, a kick, a pressure, a plane, a wetted surface.
SolidSetup busy_fold(int n_threads) {
  VocalFoldShape shape;
  shape.section.medial_thickness = 1.75e-3;
  shape.n_elements = {4, 5, 4};
  shape.half_length = true;
  SolidSetup setup;
  setup.mesh = make_vocal_fold_mesh(shape);
  setup.properties = {{MooneyRivlin{2290, 250, 100e3}, 1040}};
  setup.supports = {{"lateral", "anterior"}, {{"posterior", 2}}, {}};
  setup.wetted = {"inferior", "medial", "superior"};
  setup.damping = {0.05, 4.5 * coupling_step, 400};
  setup.kicks = {{3.3 * coupling_step, [](const Eigen::Vector3d& x) { return Eigen::Vector3d(0, 60 * x.y(), 0); }}};
  setup.pressures = {{"inferior", [](double t) { return 1e7 * t; }}};
  setup.planes = {{{0, 0.01001, 0}, {0, -1, 0}, 1e8, {}}};
  setup.step.estimate_every = 4;
  setup.n_threads = n_threads;
  return setup;
}

surface::NodeArray load(const SolidModel& model, double time) {
  surface::NodeArray force(static_cast<Eigen::Index>(model.wetted().solid_node.size()), 3);
  for (Eigen::Index n = 0; n < force.rows(); ++n)
    force.row(n) << 1e-5 * std::sin(1e4 * time + 0.1 * static_cast<double>(n)), 2e-5, 0;
  return force;
}

void step(SolidModel& model) {
  model.solve_step(coupling_step, load(model, model.accepted().motion.time + coupling_step));
  model.accept_step();
}

void expect_equal_bits(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.interface_force, b.interface_force);
  EXPECT_EQ(a.n_kicks_done, b.n_kicks_done);
}

TEST(SolidModel, GivesTheSameBitsForAnyNumberOfThreads) {
  SolidModel one(busy_fold(1)), two(busy_fold(2)), three(busy_fold(3));
  for (int n = 0; n < 20; ++n) {
    step(one);
    step(two);
    step(three);
  }
  EXPECT_GT(one.energy().contact, 0);  // the plane was reached
  expect_equal_bits(one.accepted().motion, two.accepted().motion);
  expect_equal_bits(one.accepted().motion, three.accepted().motion);
  EXPECT_EQ(one.accepted().motion.estimate.stable_step, two.accepted().motion.estimate.stable_step);
  EXPECT_EQ(one.energy().strain, three.energy().strain);
}

TEST(SolidModel, SolvesAgainFromTheAcceptedStateWithTheSameBits) {
  SolidModel often(busy_fold(1)), once(busy_fold(1));
  for (int n = 0; n < 10; ++n) {
    often.solve_step(coupling_step / 3, 5 * load(often, 0));  // what is thrown away leaves no trace
    often.solve_step(2 * coupling_step, load(often, 1));
    step(often);
    step(once);
  }
  expect_equal_bits(often.accepted().motion, once.accepted().motion);
}

TEST(SolidModel, ContinuesFromAKeptStateWithTheSameBits) {
  SolidModel through(busy_fold(1)), first(busy_fold(1)), second(busy_fold(2));
  for (int n = 0; n < 7; ++n) {
    step(through);
    step(first);
  }
  second.resume(first.accepted());
  for (int n = 0; n < 7; ++n) {
    step(through);
    step(second);
  }
  expect_equal_bits(through.accepted().motion, second.accepted().motion);
  EXPECT_EQ(through.accepted().motion.estimate.stable_step, second.accepted().motion.estimate.stable_step);
}

/// A column of 1 x 6 x 1 m, held at its foot, whose top is given a spin: it is twisted by more than a turn and recoils.
SolidSetup twisted_column(int n_threads) {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{1, 6, 1}, {2, 12, 2}});
  setup.properties = {{NeoHookean{17e6 / 2.99, 17e6 / 0.03}, 1100}};
  setup.supports.fixed = {"y_min"};
  setup.kicks = {{0, [](const Eigen::Vector3d& x) {
                    const double omega = 105 * std::sin(std::numbers::pi * x.y() / 12);
                    return Eigen::Vector3d(omega * (x.z() - 0.5), 0, -omega * (x.x() - 0.5));
                  }}};
  setup.n_threads = n_threads;
  return setup;
}

const surface::NodeArray no_load = surface::NodeArray::Zero(0, 3);
constexpr double long_step = 0.05;  // [s]: some 300 substeps

void long_step_of(SolidModel& model) {
  model.solve_step(long_step, no_load);
  model.accept_step();
}

TEST(SolidModel, EstimatesTheStableStepAgainInTheMidstOfAStep) {
  SolidModel one(twisted_column(1)), three(twisted_column(3)), repeated(twisted_column(1));
  long_step_of(one);
  const double energy = one.energy().kinetic + one.energy().strain;
  repeated.solve_step(2 * long_step, no_load);  // leaves no trace
  for (SolidModel* model : {&three, &repeated}) long_step_of(*model);
  EXPECT_GT(one.accepted().motion.estimate.displacement->norm(), 0);  // not the first one any more
  EXPECT_GT(one.accepted().motion.estimate.n_substeps, 0);            // and not at the end of the step
  SolidModel resumed(twisted_column(2));
  resumed.resume(one.accepted());
  for (int n = 0; n < 2; ++n)  // over the largest twist, at 0.08 s
    for (SolidModel* model : {&one, &three, &repeated, &resumed}) long_step_of(*model);
  for (const SolidModel* model : {&three, &repeated, &resumed}) {
    expect_equal_bits(one.accepted().motion, model->accepted().motion);
    EXPECT_EQ(one.accepted().motion.estimate.stable_step, model->accepted().motion.estimate.stable_step);
    EXPECT_EQ(*one.accepted().motion.estimate.displacement, *model->accepted().motion.estimate.displacement);
  }
  // The method's energy error at 0.9 of the stable step is some 1e-5 here; a step beyond it would multiply the energy.
  EXPECT_NEAR((one.energy().kinetic + one.energy().strain) / energy, 1, 1e-3);
}

TEST(SolidModel, GivesAStepUpWhenTheWatchSaysSo) {
  SolidModel undisturbed(twisted_column(1)), watched(twisted_column(2));
  std::vector<double> times;
  watched.set_watch([&](double time) {
    times.push_back(time);
    return times.size() < 100;
  });
  EXPECT_THROW(watched.solve_step(long_step, no_load), report::Interrupted);
  EXPECT_EQ(times.size(), 100U);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_LT(times.back(), long_step);
  EXPECT_EQ(watched.accepted().motion.time, 0);
  watched.set_watch({});
  long_step_of(watched);
  long_step_of(undisturbed);
  expect_equal_bits(undisturbed.accepted().motion, watched.accepted().motion);
}

TEST(SolidModel, KeepsItsSupports) {
  SolidModel model(busy_fold(1));
  for (int n = 0; n < 10; ++n) step(model);
  const auto& u = model.accepted().motion.displacement;
  EXPECT_GT(u.cwiseAbs().maxCoeff(), 1e-5);
  for (const Index n : nodes_of_faces(model.mesh(), model.mesh().surface.at("lateral"))) EXPECT_EQ(u.row(n).norm(), 0);
  for (const Index n : nodes_of_faces(model.mesh(), model.mesh().surface.at("posterior"))) EXPECT_EQ(u(n, 2), 0);
}

/// A free cube of 1 m that is kicked at 1 ms to 1 m/s.
SolidSetup kicked_cube() {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
  setup.properties = {{SaintVenantKirchhoff::from_young(1e6, 0.3), 1000}};
  setup.kicks = {{1e-3, [](const Eigen::Vector3d&) { return Eigen::Vector3d(1, 0, 0); }}};
  return setup;
}

TEST(SolidModel, KicksExactlyOnceWhateverTheSteps) {
  for (const double duration : {1e-4, 3.7e-4, 1e-3, 5e-3, 2e-2}) {
    SolidModel model(kicked_cube());
    while (model.accepted().motion.time < 2e-2) {
      model.solve_step(duration, surface::NodeArray::Zero(0, 3));
      model.accept_step();
    }
    const auto& v = model.accepted().motion.velocity;
    EXPECT_NEAR(v.col(0).minCoeff(), 1, 1e-12) << duration;
    EXPECT_NEAR(v.col(0).maxCoeff(), 1, 1e-12) << duration;
    EXPECT_NEAR(model.energy().kinetic, 500, 1e-9);  // 1000 kg
  }
}

TEST(SolidModel, TakesNoSubstepLongerThanAsked) {
  SolidSetup setup = kicked_cube();
  SolidModel free(setup);
  setup.step.largest_substep = 1e-4;
  SolidModel limited(setup);
  EXPECT_EQ(limited.n_substeps(1e-3), 10);
  const double longest = 0.9 * free.accepted().motion.estimate.stable_step;
  EXPECT_EQ(free.n_substeps(longest), 1);
  EXPECT_EQ(free.n_substeps(1.01 * longest), 2);
}

TEST(SolidModel, NamesElementAndTimeWhenAnElementIsTurnedInsideOut) {
  SolidSetup setup = kicked_cube();
  setup.pressures = {{"x_max", [](double t) { return t < 0.5e-3 ? 0.0 : 1e8; }}};
  SolidModel model(setup);
  try {
    for (int n = 0; n < 100; ++n) {
      model.solve_step(1e-3, surface::NodeArray::Zero(0, 3));
      model.accept_step();
    }
    FAIL();
  } catch (const report::NumericsError& error) {
    EXPECT_NE(error.where().find("t = "), std::string::npos) << error.what();
    EXPECT_NE(error.sentence().find("element "), std::string::npos) << error.what();
    EXPECT_FALSE(error.advice().empty());
  }
}

TEST(SolidModel, RefusesAPlaneThatNothingCanTouch) {
  SolidSetup setup = kicked_cube();
  setup.planes = {{{0, 2, 0}, {0, -1, 0}, 1e6, {}}};
  EXPECT_THROW(SolidModel{setup}, report::SceneError);
}

TEST(SolidModel, RefusesABodyThatCannotMove) {
  SolidSetup setup = kicked_cube();
  setup.mesh = make_box_mesh({{1, 1, 1}, {1, 1, 1}});
  setup.supports.fixed = {"x_min", "x_max"};
  setup.supports.symmetry = {{"y_min", 0}, {"y_min", 1}, {"y_min", 2}, {"y_max", 0}, {"y_max", 1}, {"y_max", 2}};
  EXPECT_THROW(SolidModel{setup}, report::SceneError);
}

}  // namespace
}  // namespace couplet::solid
