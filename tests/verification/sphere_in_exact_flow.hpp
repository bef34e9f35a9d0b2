#pragma once
// A sphere in an exact flow in three dimensions: the errors that its wall leaves.

#include <algorithm>
#include <array>
#include <vector>

#include "flow-server/immersed/body_shape.hpp"
#include "flow-server/immersed/surface_tessellation.hpp"
#include "tests/oracle/ethier_steinman.hpp"
#include "tests/verification/flow_cases.hpp"

namespace couplet::flow {

/// The flow of Ethier and Steinman in the box from -1 to 1 outside a sphere of radius 0.5 on which the wall imposes the
/// exact velocity, wherever the sphere is: the flow outside stays the exact one, at rest or while the sphere moves
/// through the grid.
struct SphereInExactFlow {
  int n = 16;            // cells along each side of the box
  double drift = 0;      // speed of the sphere along x; along y and z 0.6 and -0.4 of it [m/s]
  double until = 0.1;    // [s]
  int steps_a_cell = 3;  // number of steps over n
  TimeScheme scheme = TimeScheme::adams_bashforth;
  bool has_sphere = true;

  static constexpr double radius = 0.5;  // [m]
  double cell_width() const { return 2.0 / n; }
  Point centre(double t) const { return {0.03 + drift * t, -0.05 + 0.6 * drift * t, 0.02 - 0.4 * drift * t}; }
  /// Of a place from the sphere, negative inside it.
  double distance(const Point& at, double t) const {
    const Point c = centre(t);
    return has_sphere ? std::hypot(at[0] - c[0], at[1] - c[1], at[2] - c[2]) - radius : radius;
  }
};

/// Over all faces and cells with their middles in the fluid. A pressure is known but for a constant: that whose mean
/// error is nothing a cell away from the wall and further.
struct SphereErrors {
  Norms velocity, pressure;           // [m/s], [Pa]
  double pressure_beyond_a_cell = 0;  // largest, of cells a cell away from the wall and further [Pa]
  int n_steps = 0;
};

inline NavierStokesSetup sphere_in_exact_flow(const SphereInExactFlow& sphere, const oracle::EthierSteinman& exact) {
  const std::vector<double> faces = uniform_faces(-1, 1, sphere.n);
  NavierStokesSetup setup = setup_on(box_grid({faces, faces, faces}, {false, false, false}), sphere.scheme);
  setup.viscosity = exact.viscosity;
  setup.balances_inflow = true;  // velocities at the middle of faces sum up to zero to second order only
  setup.pressure.relative_tolerance = 1e-6;
  setup.pressure.divergence_tolerance = 1e-9;
  setup.initial_pressure = SpaceTimeValue([exact](const Point& at, double) { return exact.pressure(at, 0); });
  PrescribedVelocity border;
  for (std::size_t c = 0; c < 3; ++c) {
    border.velocity[c] =
        SpaceTimeValue([exact, c](const Point& at, double t) { return exact.velocity(static_cast<int>(c), at, t); });
    setup.initial_velocity[c] = border.velocity[c];
  }
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t side = 0; side < 2; ++side)
      setup.border[d][side] = {FacePatch{.name = "exact", .condition = border}};
  if (!sphere.has_sphere) return setup;
  // Sides of half a cell: the triangles' own distance from the sphere falls with the square of the cell's width too,
  // and is 1/16 of what a wall of one straight piece a cell has.
  const double R = SphereInExactFlow::radius;
  const surface::SurfaceMesh mesh = make_ellipsoid({0, 0, 0}, {R, R, R}, 0.5 * sphere.cell_width());
  BodySurface ball;
  ball.name = "sphere";
  ball.is_closed = true;
  const SurfaceTessellation tessellation(mesh, ball.name, {});
  tessellation.interpolate(mesh.node_position, ball.position);
  ball.triangle = tessellation.triangle();
  ball.velocity.resize(ball.position.size());
  setup.bodies = [sphere, exact, ball](double t) {
    BodySurface placed = ball;
    const Point middle = sphere.centre(t);
    for (std::size_t i = 0; i < placed.position.size(); ++i) {
      for (std::size_t d = 0; d < 3; ++d) placed.position[i][d] += middle[d];
      for (int d = 0; d < 3; ++d)
        placed.velocity[i][static_cast<std::size_t>(d)] = exact.velocity(d, placed.position[i], t);
    }
    return std::vector<BodySurface>{placed};
  };
  return setup;
}

/// Collective.
inline SphereErrors errors_around_sphere(const SphereInExactFlow& sphere) {
  const oracle::EthierSteinman exact{0.05};
  const NavierStokesSetup setup = sphere_in_exact_flow(sphere, exact);
  const BlockDecomposition blocks = decompose(setup.grid);
  FractionalStep flow(setup, blocks);
  FlowState state = flow.initial_state(), next;
  SphereErrors errors;
  const int n_steps = sphere.steps_a_cell * sphere.n;
  for (int step = 0; step < n_steps; ++step) {
    errors.n_steps += flow.advance(state, sphere.until / n_steps, next).n_steps;
    std::swap(state, next);
  }
  const Box mine = flow.decomposition().mine();
  const double h = sphere.cell_width();
  /// Calls with(error, distance from the sphere) for a component, or for the pressure (-1).
  const auto visit = [&](int component, const auto& with) {
    for (int k = 0; k < mine.size(2); ++k)
      for (int j = 0; j < mine.size(1); ++j)
        for (int i = 0; i < mine.size(0); ++i) {
          const Triple cell{i, j, k};
          Point at;
          for (int d = 0; d < 3; ++d)
            at[static_cast<std::size_t>(d)] = -1 + h * (mine.begin[d] + cell[d] + (d == component ? 1 : 0.5));
          const double distance = sphere.distance(at, state.time);
          if (distance <= 0) continue;
          if (component < 0)
            with(state.pressure(i, j, k) - exact.pressure(at, state.pressure_time), distance);
          else
            with(state.velocity[static_cast<std::size_t>(component)](i, j, k) -
                     exact.velocity(component, at, state.time),
                 distance);
        }
  };
  std::array<double, 3> largest{};
  double squares = 0, n_values = 0;
  for (int c = 0; c < 3; ++c)
    visit(c, [&](double error, double) {
      largest[0] = std::max(largest[0], std::abs(error));
      squares += error * error, ++n_values;
    });
  errors.velocity.rms = std::sqrt(summed(squares) / summed(n_values));
  double sum = 0, n_far = 0, n_cells = 0;
  visit(-1, [&](double error, double distance) {
    ++n_cells;
    if (distance > h) sum += error, ++n_far;
  });
  const double mean = summed(sum) / summed(n_far);
  squares = 0;
  visit(-1, [&](double error, double distance) {
    largest[1] = std::max(largest[1], std::abs(error - mean));
    if (distance > h) largest[2] = std::max(largest[2], std::abs(error - mean));
    squares += (error - mean) * (error - mean);
  });
  errors.pressure.rms = std::sqrt(summed(squares) / summed(n_cells));
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), 3, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  errors.velocity.largest = largest[0], errors.pressure.largest = largest[1];
  errors.pressure_beyond_a_cell = largest[2];
  return errors;
}

}  // namespace couplet::flow
