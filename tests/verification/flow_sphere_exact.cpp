// Order of convergence beside the wall of a sphere, in an unsteady flow in three dimensions.

#include <gtest/gtest.h>

#include "tests/verification/sphere_in_exact_flow.hpp"

namespace couplet::flow {
namespace {

struct SphereCase {
  const char* name;
  double drift;  // [m/s]; at 1.2 the sphere goes through 1.4 cells along x on the coarse grid and 2.9 on the fine one
  TimeScheme scheme;
  int steps_a_cell;
};

class OrderBesideSphere : public testing::TestWithParam<SphereCase> {};

TEST_P(OrderBesideSphere, LargestErrorsConverge) {
  const auto errors_on = [](int n) {
    const SphereCase& c = GetParam();
    return errors_around_sphere({.n = n, .drift = c.drift, .steps_a_cell = c.steps_a_cell, .scheme = c.scheme});
  };
  const SphereErrors coarse = errors_on(24), fine = errors_on(48);
  const double of_velocity = order_between(coarse.velocity.largest, fine.velocity.largest);
  const double of_pressure = order_between(coarse.pressure_beyond_a_cell, fine.pressure_beyond_a_cell);
  RecordProperty("velocity", std::to_string(of_velocity));
  RecordProperty("pressure_beyond_a_cell", std::to_string(of_pressure));
  RecordProperty("pressure_in_all_cells",
                 std::to_string(order_between(coarse.pressure.largest, fine.pressure.largest)));
  // As of a circle (flow_bodies.cpp): second order is meant, 1.9 is what the largest of 300,000 errors leaves of it;
  // the pressure beside walls is known in the middles of cells, not of their parts. Where pieces of faces behind an
  // oblique wall had one slope in place of two the velocity was of order 1.4.
  EXPECT_GE(of_velocity, 1.9) << coarse.velocity.largest << " " << fine.velocity.largest;
  EXPECT_GE(of_pressure, 1.5) << coarse.pressure_beyond_a_cell << " " << fine.pressure_beyond_a_cell;
}

// Steps in proportion with the cells' width, as long as stability lets them be.
INSTANTIATE_TEST_SUITE_P(Cases, OrderBesideSphere,
                         testing::Values(SphereCase{"at_rest", 0, TimeScheme::adams_bashforth, 3},
                                         SphereCase{"moving", 1.2, TimeScheme::adams_bashforth, 3},
                                         SphereCase{"stages", 1.2, TimeScheme::runge_kutta, 1}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace couplet::flow
