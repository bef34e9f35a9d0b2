#pragma once
// Everything that the incompressible flow solver needs to know, in plain values.

#include <functional>
#include <limits>
#include <optional>

#include "flow-server/boundary/face_condition.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_geometry.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

enum class TimeScheme {
  automatic,        // whichever takes the interval at the least cost inside its stability limit
  adams_bashforth,  // second order, one evaluation a step
  runge_kutta,      // third order low-storage Runge-Kutta, one projection a step: second order in all
  crank_nicolson,   // convection and diffusion implicit, by line solves
};

struct StepLimits {
  double courant =
      std::numeric_limits<double>::quiet_NaN();  // largest sum of |u| dt / dx; not a number: the scheme's own
  double smallest = 0;                           // below it: NumericsError [s]
  double largest = std::numeric_limits<double>::infinity();  // [s]
};

struct PressureSettings {
  PressureMethod method = PressureMethod::automatic;
  double relative_tolerance = 1e-3;    // of the residual of the pressure increment
  double divergence_tolerance = 1e-9;  // enough: root mean square of div u times smallest cell width over largest speed
  int largest_iterations = 60;
};

struct NavierStokesSetup {
  StretchedGrid grid;
  double density = 1;    // [kg/m^3]
  double viscosity = 0;  // dynamic [Pa s]
  BorderConditions border;
  VectorValue body_force;           // [N/m^3]
  VectorValue initial_velocity;     // at t = 0 [m/s]
  SpaceTimeValue initial_pressure;  // at t = 0 [Pa]
  std::function<bool(const Point& centre)>
      is_fluid;  // not set: every cell; walls at rest where fluid ends, along cell faces
  TimeScheme scheme = TimeScheme::automatic;
  StepLimits step;
  PressureSettings pressure;
  bool balances_inflow = false;  // spread a net inflow over the prescribed inlets where it has no way out
  /// The surfaces in the flow at a time, always the same ones in the same order; not set: there are none.
  std::function<std::vector<BodySurface>(double time)> bodies = {};
  BodyFlowSettings body_settings = {};

  double kinematic_viscosity() const { return viscosity / density; }  // [m^2/s]
};

}  // namespace couplet::flow
