#include "flow-server/immersed/prescribed_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {
namespace {

using std::numbers::pi;
const Point origin{0, 0, 0};

std::vector<Joint> wing_on_a_body() {
  const FourierSeries heave{.frequency = 2, .mean = 0.1, .cosine = {0.2, 0.05}, .sine = {0, 0.03, 0.01}};
  const scene::TimeTable surge{.time = {0, 1, 2}, .value = {0, 1, -1}, .cosine = true};
  const TimeFormula sway{[](double t) { return 0.1 * std::sin(3 * t) * t; }, 1e-3};
  return {Translation{{TimeFunction(surge), TimeFunction(sway), TimeFunction(heave)}},
          Rotation{{0.2, 0, 0}, {0, 1, 0}, FourierSeries{.frequency = 1, .cosine = {0.3}, .sine = {}}},
          Rotation{{0, 0.5, 0}, {1, 0, 0}, FourierSeries{.frequency = 2, .cosine = {1.2}, .sine = {0.1}}},
          Rotation{{0, 0.5, 0}, {0, 0, 2}, TimeFunction(0.2)},
          Rotation{{0, 0.5, 0}, {0, 1, 0}, FourierSeries{.frequency = 2, .mean = 0.4, .cosine = {}, .sine = {0.8}}}};
}

TEST(TimeFunction, RatesAreThoseOfTheValues) {
  const std::vector<TimeFunction> functions = {
      3.0, scene::TimeTable{.time = {0, 1, 3}, .value = {0, 2, 1}, .cosine = false},
      scene::TimeTable{.time = {0, 1, 3}, .value = {0, 2, 1}, .cosine = true},
      FourierSeries{.frequency = 0.7, .mean = 1, .cosine = {1, 2, 3}, .sine = {0.5}},
      TimeFormula{[](double t) { return std::exp(-t) * std::sin(5 * t); }, 1e-3}};
  constexpr double d = 1e-5;
  for (const TimeFunction& f : functions) {
    for (const double t : {-0.5, 0.3, 1.4, 2.9, 3.5}) {
      // The difference quotient is off by d^2 f''' / 6 (f''' up to 1e4) and by round-off 1e-16 / d.
      EXPECT_NEAR(f.rate(t), (f.at(t + d) - f.at(t - d)) / (2 * d), 1e-6);
    }
  }
}

TEST(TimeFunction, AtARowOfATableTheRateIsThatOfThePartThatEndsThere) {
  const TimeFunction f = scene::TimeTable{.time = {0, 1, 2}, .value = {0, 2, 1}, .cosine = false};
  EXPECT_EQ(f.rate(0), 0);
  EXPECT_EQ(f.rate(1), 2);
  EXPECT_EQ(f.rate(2), -1);
  EXPECT_EQ(f.rate(2.1), 0);
}

TEST(PrescribedMotion, VelocityIsTheRateOfPositionThroughAllJoints) {
  const PrescribedMotion motion(wing_on_a_body());
  const std::vector<Point> at_rest = {{0, 0, 0}, {0.3, 1.5, -0.1}, {-2, 1, 4}};
  constexpr double d = 1e-5;
  for (const double t : {0.05, 0.4, 1.7}) {
    BodySurface now, before, after;
    motion.move(at_rest, t, now);
    motion.move(at_rest, t - d, before);
    motion.move(at_rest, t + d, after);
    for (std::size_t i = 0; i < at_rest.size(); ++i) {
      const Point difference = (1 / (2 * d)) * (after.position[i] - before.position[i]);
      // d^2 x''' / 6 with x''' up to 4 (2 pi 4)^3; round-off 1e-15 / d.
      EXPECT_LT(distance(now.velocity[i], difference), 4e-6) << i << " " << t;
    }
    EXPECT_NEAR(distance(now.position[0], now.position[1]), distance(at_rest[0], at_rest[1]), 1e-14);  // rigid
  }
}

TEST(PrescribedMotion, OuterJointsCarryInnerAxes) {
  // First joint: a quarter turn about z through the origin; second: about the body's own x axis.
  const PrescribedMotion motion(
      {Rotation{origin, {0, 0, 1}, TimeFunction(pi / 2)}, Rotation{origin, {1, 0, 0}, TimeFunction(pi / 2)}});
  const std::vector<Point> at_rest = {{0, 1, 0}, {1, 0, 0}};
  BodySurface surface;
  motion.move(at_rest, 0, surface);
  EXPECT_LT(distance(surface.position[0], {0, 0, 1}), 1e-15);  // y to z about x, then about z: stays
  EXPECT_LT(distance(surface.position[1], {0, 1, 0}), 1e-15);
  EXPECT_TRUE(motion.is_fixed());
  EXPECT_FALSE(PrescribedMotion(wing_on_a_body()).is_fixed());
}

TEST(PrescribedMotion, TheDutschCylinderMovesAsPublished) {
  // x = -A sin(2 pi f t), KC = 5: A = 5 D / (2 pi).
  const double amplitude = 5 / (2 * pi);
  const PrescribedMotion motion(
      {Translation{{FourierSeries{.frequency = 0.2, .cosine = {}, .sine = {-amplitude}}, 0.0, 0.0}}});
  const RigidPose quarter = motion.pose(1.25), start = motion.pose(0);
  EXPECT_NEAR(quarter.shift[0], -amplitude, 1e-15);
  EXPECT_NEAR(quarter.shift_rate[0], 0, 1e-15);
  EXPECT_NEAR(start.shift_rate[0], -1, 1e-15);  // largest speed 2 pi f A = 1
}

TEST(PrescribedMotion, ReportsItsAngularVelocity) {
  const PrescribedMotion motion(
      {Rotation{{1, 2, 3}, {0, 0, 5}, FourierSeries{.frequency = 1, .cosine = {}, .sine = {0.1}}}});
  const Eigen::Vector3d spin = motion.pose(0).angular_velocity();
  EXPECT_NEAR(spin.z(), 0.1 * 2 * pi, 1e-15);
  EXPECT_NEAR(spin.head<2>().norm(), 0, 1e-15);
}

}  // namespace
}  // namespace couplet::flow
