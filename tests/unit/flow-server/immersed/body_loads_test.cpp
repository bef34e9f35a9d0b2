#include "flow-server/immersed/body_loads.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "flow-server/immersed/triangle_geometry.hpp"
#include "tests/unit/flow-server/immersed/placed_bodies.hpp"
#include "tests/unit/flow-server/immersed/test_surfaces.hpp"

namespace couplet::flow {
namespace {

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

Vector vector(const Point& p) {
  return {p[0], p[1], p[2]};
}

/// Every corner moves as u = G x.
void move_linearly(BodySurface& surface, const Matrix& gradient) {
  for (std::size_t c = 0; c < surface.position.size(); ++c)
    Vector::Map(surface.velocity[c].data()) = gradient * vector(surface.position[c]);
}

Vector sum_of(const SurfaceLoad& load) {
  Vector sum = Vector::Zero();
  for (const Point& force : load.corner_force) sum += vector(force);
  return sum;
}

void expect_dual_pressure(const StretchedGrid& grid, std::vector<BodySurface> surfaces) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (BodySurface& surface : surfaces)
    for (Point& velocity : surface.velocity) velocity = {number(random), number(random), number(random)};
  PlacedBodies placed(grid, surfaces);
  placed.set_pressure([&](const Point&) { return number(random); });
  std::vector<SurfaceLoad> loads = BodyLoads::no_loads(surfaces);
  BodyLoads(placed.block, 0).add_pressure(*placed.bodies, placed.pressure, loads);
  double work = 0, size = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (std::size_t c = 0; c < surfaces[s].position.size(); ++c) {
      work += dot(loads[s].corner_force[c], surfaces[s].velocity[c]);
      size += std::abs(dot(loads[s].corner_force[c], surfaces[s].velocity[c]));
    }
  // What ImmersedBodies::take_divergence() counts at walls, times the pressure of the parts that it takes it from.
  const BodyGeometry& bodies = *placed.bodies;
  const CutCells& cut = bodies.cut();
  double through_walls = 0;
  for (const CutCell& cell : cut.cells()) {
    if (!box_of(placed.block.sizes).contains(cell.cell)) continue;
    const auto pressure_of = [&](int part) {
      if (!cut.parts()[static_cast<std::size_t>(part)].is_fluid) return 0.0;
      return bodies.pieces().value_at(part, cell.cell, placed.pressure, bodies.piece_pressure);
    };
    for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
      const WallTriangle& wall = cut.walls()[static_cast<std::size_t>(w)];
      if (wall.outer_part == wall.inner_part) continue;
      through_walls += (pressure_of(wall.inner_part) - pressure_of(wall.outer_part)) * (1 - wall.opening) *
                       wall.velocity.dot(wall.area);
    }
  }
  ASSERT_GT(size, 0);
  EXPECT_NEAR(work, through_walls, 1e-13 * size);  // round-off of some thousand terms
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    EXPECT_LT((sum_of(loads[s]) - vector(loads[s].pressure_force)).norm(), 1e-13 * size);
}

TEST(BodyLoads, WorkOfThePressureIsThePressureTimesTheFlowThroughTheWalls) {
  expect_dual_pressure(uniform_box({16, 16, 16}, 1.0 / 16), {sphere_surface({0.51, 0.48, 0.5}, 0.3, 4)});
  expect_dual_pressure(uniform_box({16, 16, 16}, 1.0 / 16),
                       {sphere_surface({0.3, 0.48, 0.5}, 0.2, 4), sphere_surface({0.75, 0.5, 0.5}, 0.15, 3)});
  expect_dual_pressure(uniform_box({16, 16, 16}, 1.0 / 16),
                       {sphere_surface({0.4, 0.48, 0.5}, 0.2, 4), sphere_surface({0.6, 0.5, 0.5}, 0.15, 3)});
  expect_dual_pressure(uniform_box({32, 32, 1}, 1.0 / 32, 2), {cylinder_surface({0.5, 0.52, 0}, 0.23, 90, 1.0 / 32)});
  // A sheet that opens towards its ends.
  BodySurface sheet = flat_sheet({0.2, 0.25, 0.21}, {0.6, 0.1, 0.05}, {-0.05, 0.5, 0.1}, 40);
  for (const Point& p : sheet.position) sheet.opening.push_back(std::clamp((p[0] - 0.6) / 0.1, 0.0, 1.0));
  expect_dual_pressure(uniform_box({16, 16, 16}, 1.0 / 16), {sheet});
}

/// The force on each of some bodies in a pressure that is 1 everywhere.
std::vector<Vector> forces_in_even_pressure(const StretchedGrid& grid, const std::vector<BodySurface>& surfaces) {
  PlacedBodies placed(grid, surfaces);
  placed.set_pressure([](const Point&) { return 1.0; });
  std::vector<SurfaceLoad> loads = BodyLoads::no_loads(surfaces);
  BodyLoads(placed.block, 0).add_pressure(*placed.bodies, placed.pressure, loads);
  std::vector<Vector> forces;
  for (const SurfaceLoad& load : loads) forces.push_back(sum_of(load));
  return forces;
}

TEST(BodyLoads, AnEvenPressureHasNoForceOnBodiesThatStandInEachOther) {
  const int n = 32;
  const double h = 1.0 / n;
  for (const double shift : {0.0, 0.13, 0.29, 0.41, 0.57, 0.76, 0.88}) {
    // A plate of the thickness t = 0.14 that sticks out of a cylinder, by a cell's share higher than its middle.
    const double low = 0.43 + shift * h, high = 0.57 + shift * h, radius = 0.2;
    BodySurface plate = cylinder_surface({0, 0, 0}, 1, 4, h);
    const Point corners[] = {{0.9, high, 0}, {0.5, high, 0}, {0.5, low, 0}, {0.9, low, 0}};
    for (std::size_t c = 0; c < 8; ++c) plate.position[c] = {corners[c % 4][0], corners[c % 4][1], c < 4 ? 0 : h};
    const std::vector<Vector> forces =
        forces_in_even_pressure(uniform_box({n, n, 1}, h, 2), {cylinder_surface({0.5, 0.5, 0}, radius, 180, h), plate});
    EXPECT_LT((forces[0] + forces[1]).norm(), 1e-14 * n) << shift;
    // On the plate the push against its end t h is left, and across it t times the difference of where its sides begin.
    const auto begin = [&](double y) { return std::sqrt(radius * radius - (y - 0.5) * (y - 0.5)); };
    const Vector expected(-(high - low) * h, (begin(high) - begin(low)) * h, 0);
    EXPECT_LT((forces[1] - expected).norm(), 0.05 * h * h)
        << shift << ": " << forces[1].transpose();  // chords are not arcs
  }
}

TEST(BodyLoads, StressInAnyLinearFlowAlongWallsThatFlowWithItIsExact) {
  // u = G x, div u = 0: t = mu (G + G^T) m. Its work on the wall that flows along is mu (G + G^T) : G times volume.
  Matrix gradient;
  gradient << 0.3, 1.1, -0.4, 0.2, 0.5, 0.9, -1.3, 0.1, -0.8;
  BodySurface sphere = sphere_surface({0.51, 0.48, 0.5}, 0.3, 5);
  move_linearly(sphere, gradient);
  PlacedBodies placed(uniform_box({20, 20, 20}, 0.05), {sphere});
  placed.set_velocity([&](const Point& x, int d) { return (gradient * vector(x))[d]; });
  std::vector<SurfaceLoad> loads = BodyLoads::no_loads(placed.bodies->surfaces());
  const double viscosity = 0.7;
  BodyLoads(placed.block, viscosity).add_viscous_stress(*placed.bodies, placed.velocity, loads);
  double work = 0, volume = 0;
  for (std::size_t c = 0; c < sphere.position.size(); ++c) work += dot(loads[0].corner_force[c], sphere.velocity[c]);
  for (const WallTriangle& wall : placed.bodies->cut().walls()) volume += wall.centroid.dot(wall.area) / 3;
  const double exact = viscosity * (gradient + gradient.transpose()).cwiseProduct(gradient).sum() * volume;
  // Second order in h / R = 0.17; mu |G| area = 1.8 is the scale of forces.
  EXPECT_NEAR(work, exact, 0.03 * exact);
  EXPECT_LT(vector(loads[0].viscous_force).norm(), 1e-2);  // a constant stress on a closed surface adds up to nothing
}

TEST(BodyLoads, FluidThatTurnsWithABodyHardlyShearsIt) {
  Matrix spin;
  spin << 0, -1.3, 0.4, 1.3, 0, -0.9, -0.4, 0.9, 0;
  for (const int n_dimensions : {2, 3}) {
    if (n_dimensions == 2) spin(0, 2) = spin(2, 0) = spin(1, 2) = spin(2, 1) = 0;
    BodySurface body = n_dimensions == 2 ? cylinder_surface({0.51, 0.48, 0}, 0.3, 100, 0.05)
                                         : sphere_surface({0.51, 0.48, 0.5}, 0.3, 5);
    move_linearly(body, spin);
    PlacedBodies placed(uniform_box({20, 20, n_dimensions == 2 ? 1 : 20}, 0.05, n_dimensions), {body});
    placed.set_velocity([&](const Point& x, int d) { return (spin * vector(x))[d]; });
    std::vector<SurfaceLoad> loads = BodyLoads::no_loads(placed.bodies->surfaces());
    BodyLoads(placed.block, 0.7).add_viscous_stress(*placed.bodies, placed.velocity, loads);
    double shear = 0, area = 0;
    for (const Point& force : loads[0].corner_force) shear += length(force);
    for (const WallTriangle& wall : placed.bodies->cut().walls()) area += wall.area.norm();
    // Second order in h / R = 0.17, against mu |w| area: what one would have without the wall's own gradient.
    EXPECT_LT(shear, 0.02 * 0.7 * spin.norm() / std::sqrt(2.0) * area);
  }
}

TEST(BodyLoads, ASheetFeelsTheShearOnEachOfItsSides) {
  // A tilted sheet right through the box slides along itself; shear rates 2 and -5 on its sides.
  const double angle = 0.4, viscosity = 0.3, slide = 0.6;
  const Vector along(std::cos(angle), std::sin(angle), 0), normal(-std::sin(angle), std::cos(angle), 0);
  const Vector middle(0.5, 0.5, 0);
  BodySurface sheet =
      flat_sheet({0.5 - 2 * along[0], 0.5 - 2 * along[1], 0}, {4 * along[0], 4 * along[1], 0}, {0, 0, 0.05}, 60);
  for (Point& velocity : sheet.velocity) Vector::Map(velocity.data()) = slide * along;
  PlacedBodies placed(uniform_box({20, 20, 1}, 0.05, 2), {sheet});
  const Vector outer(vector(sheet.position[1]) - vector(sheet.position[0]));
  const double side = outer.cross(Vector(0, 0, 1)).dot(normal) > 0 ? 1 : -1;  // of the triangles' normals
  placed.set_velocity([&](const Point& x, int d) {
    const double height = (vector(x) - middle).dot(normal);
    return (slide + (height > 0 ? 2 : 5) * height) * along[d];
  });
  std::vector<SurfaceLoad> loads = BodyLoads::no_loads(placed.bodies->surfaces());
  BodyLoads(placed.block, viscosity).add_viscous_stress(*placed.bodies, placed.velocity, loads);
  double area = 0;
  for (const WallTriangle& wall : placed.bodies->cut().walls()) area += side * wall.area.dot(normal);
  const Vector exact = viscosity * (2 - 5) * area * along;
  EXPECT_NEAR(area, 0.05 / std::cos(angle), 1e-9);
  EXPECT_LT((vector(loads[0].viscous_force) - exact).norm(), 1e-10 * exact.norm());
  EXPECT_LT((sum_of(loads[0]) - exact).norm(), 1e-10 * exact.norm());
}

TEST(BodyLoads, MomentsAreTakenAboutAPoint) {
  BodySurface surface;
  surface.position = {{1, 0, 0}, {0, 2, 0}};
  const std::vector<Point> force{{0, 3, 0}, {5, 0, 0}};
  const Point moment = moment_about({0, 1, 0}, surface, force);
  EXPECT_DOUBLE_EQ(moment[2], 1 * 3 - 1 * 5);
  EXPECT_EQ(moment[0], 0);
  EXPECT_EQ(moment[1], 0);
}

}  // namespace
}  // namespace couplet::flow
