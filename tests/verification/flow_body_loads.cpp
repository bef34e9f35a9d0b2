// Forces on bodies: order of pressure and of viscous stress in known flows.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "flow-server/immersed/body_loads.hpp"
#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

constexpr double pi = std::numbers::pi;

struct Case {
  int n_dimensions;
  int n;  // cells along each side of the unit box
  Point centre;
  double radius;

  StretchedGrid grid() const { return uniform_box({n, n, n_dimensions == 3 ? n : 1}, 1.0 / n, n_dimensions); }
  BodySurface body() const {
    return n_dimensions == 3 ? sphere_surface(centre, radius, 6) : cylinder_surface(centre, radius, 800, 1.0 / n);
  }
  /// Of the polyhedron itself.
  double depth() const { return n_dimensions == 3 ? 1 : 1.0 / n; }
};

constexpr std::array<double, 4> places{0, 0.17, 0.39, 0.71};  // of the centre in a cell: errors depend on it

template <class Error>
double mean_error(int n_dimensions, int n, const Error& error) {
  double square = 0;
  for (const double place : places) {
    const Case one{n_dimensions, n, {0.5 + place / n, 0.5 + 0.6 * place / n, 0.5 - 0.3 * place / n}, 0.25};
    square += std::pow(error(one), 2);
  }
  return std::sqrt(square / places.size());
}

double pressure_error(const Case& one, const std::function<double(double x)>& pressure, double mean_slope) {
  PlacedBodies placed(one.grid(), {one.body()});
  placed.set_pressure([&](const Point& x) { return pressure(x[0] - one.centre[0]); });
  std::vector<SurfaceLoad> loads = BodyLoads::no_loads(placed.bodies->surfaces());
  BodyLoads(placed.block, 0).add_pressure(*placed.bodies, placed.pressure, loads);
  const double volume =
      one.n_dimensions == 3 ? 4.0 / 3 * pi * std::pow(one.radius, 3) : pi * one.radius * one.radius * one.depth();
  return loads[0].pressure_force[0] / (-mean_slope * volume) - 1;
}

TEST(FlowBodyLoads, BuoyancyAndTheForceOfACurvedPressure) {
  for (const int n_dimensions : {2, 3}) {
    // p = x: F = -V. p = x + 8 x^3: F = -(1 + 24 <x^2>) V, <x^2> = R^2 / (dimensions + 2).
    const double mean_slope = 1 + 24 * 0.0625 / (n_dimensions + 2);
    double linear[2], cubic[2];
    const std::array<int, 2> sizes = n_dimensions == 2 ? std::array{32, 128} : std::array{16, 32};
    for (std::size_t level = 0; level < 2; ++level) {
      linear[level] = mean_error(n_dimensions, sizes[level], [](const Case& one) {
        return pressure_error(
            one, [](double x) { return x; }, 1);
      });
      cubic[level] = mean_error(n_dimensions, sizes[level], [&](const Case& one) {
        return pressure_error(
            one, [](double x) { return x + 8 * x * x * x; }, mean_slope);
      });
    }
    const double finer = static_cast<double>(sizes[1]) / sizes[0];
    const auto order = [&](const double* error) { return std::log(error[0] / error[1]) / std::log(finer); };
    // A linear pressure gives the sum of the body's cross-sections at cell faces, times the width of the cells. That is
    // right to second order, but to order 1.5 for a circle, whose chord begins as a square root.
    const double expected = n_dimensions == 2 ? 1.5 : 2;
    EXPECT_GT(order(linear), expected - 0.2);
    EXPECT_GT(order(cubic), expected - 0.2);
    EXPECT_LT(linear[1], n_dimensions == 2 ? 1.3e-3 : 6e-3);  // as measured; R = 32 and 8 cells
    EXPECT_LT(cubic[1], n_dimensions == 2 ? 2.3e-3 : 7e-3);
  }
}

TEST(FlowBodyLoads, TorqueOfTheFlowAroundATurningCylinder) {
  // u_theta = A r + B / r turns with the wall; torque of a length L: -4 pi mu B L.
  const double a = 0.3, b = 0.05, viscosity = 0.1;
  const auto error = [&](const Case& one) {
    BodySurface body = one.body();
    const double spin = a + b / (one.radius * one.radius);
    for (std::size_t c = 0; c < body.position.size(); ++c)
      body.velocity[c] = {-spin * (body.position[c][1] - one.centre[1]), spin * (body.position[c][0] - one.centre[0]),
                          0};
    PlacedBodies placed(one.grid(), {body});
    placed.set_velocity([&](const Point& x, int d) {
      const double dx = x[0] - one.centre[0], dy = x[1] - one.centre[1], square = dx * dx + dy * dy;
      return (d == 0 ? -dy : dx) * (a + b / square);
    });
    std::vector<SurfaceLoad> loads = BodyLoads::no_loads(placed.bodies->surfaces());
    BodyLoads(placed.block, viscosity).add_viscous_stress(*placed.bodies, placed.velocity, loads);
    const double torque = moment_about(one.centre, body, loads[0].corner_force)[2];
    return torque / (-4 * pi * viscosity * b * one.depth()) - 1;
  };
  const double coarse = mean_error(2, 32, error), fine = mean_error(2, 128, error);
  const double order = std::log(coarse / fine) / std::log(4.0);
  EXPECT_GT(order, 1.8);
  EXPECT_LT(coarse, 0.01);  // R = 8 cells
}

TEST(FlowBodyLoads, DragOfASphereInStokesFlow) {
  // G. K. Batchelor, An Introduction to Fluid Dynamics, 4.9: one third of 6 pi mu R U by pressure, two by shear.
  const double viscosity = 0.1;
  double viscous[2], pressed[2];
  for (std::size_t level = 0; level < 2; ++level) {
    const int n = level == 0 ? 20 : 40;
    const Case one{3, n, {0.5 + 0.2 / n, 0.5 - 0.3 / n, 0.5 + 0.1 / n}, 0.25};
    PlacedBodies placed(one.grid(), {one.body()});
    const double radius = one.radius;
    placed.set_velocity([&](const Point& x, int d) {
      const double dx = x[0] - one.centre[0], dd = x[d] - one.centre[d];
      const double r = std::hypot(dx, x[1] - one.centre[1], x[2] - one.centre[2]), q = radius / r;
      return (d == 0 ? 1 - 0.75 * q - 0.25 * q * q * q : 0) - 0.75 * dx * dd / (r * r) * (q - q * q * q);
    });
    placed.set_pressure([&](const Point& x) {
      const double dx = x[0] - one.centre[0];
      const double r = std::hypot(dx, x[1] - one.centre[1], x[2] - one.centre[2]);
      return -1.5 * viscosity * radius * dx / (r * r * r);
    });
    std::vector<SurfaceLoad> loads = BodyLoads::no_loads(placed.bodies->surfaces());
    const BodyLoads measured(placed.block, viscosity);
    measured.add_viscous_stress(*placed.bodies, placed.velocity, loads);
    measured.add_pressure(*placed.bodies, placed.pressure, loads);
    viscous[level] = std::abs(loads[0].viscous_force[0] / (4 * pi * viscosity * radius) - 1);
    pressed[level] = std::abs(loads[0].pressure_force[0] / (2 * pi * viscosity * radius) - 1);
  }
  // u''' R^2 / u' = 13 at the wall: with points at 0.9 and 1.8 h, R = 10 h, that makes 13 * 1.6 / 300 = 7 %, at most.
  EXPECT_LT(viscous[1], 0.04);
  EXPECT_LT(viscous[1], viscous[0] / 2.5);
  EXPECT_LT(pressed[1], 0.01);
}

}  // namespace
}  // namespace couplet::flow
