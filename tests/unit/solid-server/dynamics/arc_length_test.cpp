#include "solid-server/dynamics/arc_length.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/solid-server/dynamics/one_spring.hpp"

namespace couplet::solid {
namespace {

/// Von Mises truss of Saint Venant-Kirchhoff bars, half span 1, EA = 1: P = z (H^2 - z^2) / L^3 at the height z of its
/// apex; the load has its limit at z = H / sqrt(3).
struct Truss {
  double rise, length = std::sqrt(1 + rise * rise);
  double force(double drop) const {
    const double z = rise - drop;
    return z * (rise * rise - z * z) / std::pow(length, 3);
  }
  double stiffness(double drop) const {
    const double z = rise - drop;
    return (3 * z * z - rise * rise) / std::pow(length, 3);
  }
  double limit() const { return force(rise * (1 - 1 / std::sqrt(3.0))); }

  OneSpring system() const {
    OneSpring spring;
    spring.spring = [*this](double u) { return force(u); };
    spring.stiffness = [*this](double u) { return stiffness(u); };
    spring.load = limit();
    return spring;
  }
};

TEST(ArcLength, PassesBothLimitsOfATruss) {
  for (const double rise : {0.1, 0.2, 0.3}) {
    const Truss truss{rise};
    OneSpring spring = truss.system();
    NodeVectors u = NodeVectors::Zero(1, 4);
    double load = 0;
    int n_unstable = 0, n_points = 0;
    ArcLengthControl control;
    control.first_load_step = 0.05;
    const PathReport report = follow_path(spring, control, u, load, 1.5, [&](const PathPoint& point) {
      const double drop = (*point.displacement)(0, 0);
      EXPECT_NEAR(point.load * truss.limit(), truss.force(drop), 1e-6 * truss.limit());
      EXPECT_EQ(point.n_negative_pivots > 0, std::abs(rise - drop) < rise / std::sqrt(3.0)) << drop / rise;
      n_unstable += point.n_negative_pivots;
      ++n_points;
      return true;
    });
    EXPECT_TRUE(report.has_reached_load) << report.failure;
    EXPECT_GT(n_unstable, 2);
    EXPECT_GT(u(0, 0), 2 * rise);  // snapped through
    ASSERT_EQ(report.limit_loads.size(), 2u);
    // A parabola through points that lie a twentieth of the way apart.
    EXPECT_NEAR(report.limit_loads[0], 1, 5e-3);
    EXPECT_NEAR(report.limit_loads[1], -1, 5e-3);
    EXPECT_EQ(report.n_negative_pivots, 0);
    EXPECT_LE(n_points, 100);
  }
}

TEST(ArcLength, EndsWhenAVisitorSaysSo) {
  OneSpring spring = Truss{0.1}.system();
  NodeVectors u = NodeVectors::Zero(1, 4);
  double load = 0;
  const PathReport report =
      follow_path(spring, {}, u, load, 2, [](const PathPoint& point) { return (*point.displacement)(0, 0) < 0.1; });
  EXPECT_FALSE(report.has_reached_load);
  EXPECT_TRUE(report.failure.empty());
  EXPECT_GE(u(0, 0), 0.1);
  EXPECT_LT(u(0, 0), 0.2);
}

TEST(ArcLength, SaysWhenThePathEnds) {
  OneSpring spring = Truss{0.1}.system();
  spring.inverted_above = 0.05;
  NodeVectors u = NodeVectors::Zero(1, 4);
  double load = 0;
  const PathReport report = follow_path(spring, {}, u, load, 2, [](const PathPoint&) { return true; });
  EXPECT_FALSE(report.has_reached_load);
  EXPECT_NE(report.failure.find("no equilibrium"), std::string::npos);
  EXPECT_LE(u(0, 0), 0.05);
}

}  // namespace
}  // namespace couplet::solid
