#pragma once
// Solutions of the Navier-Stokes equations in closed form.

#include <variant>

#include "flow-server/boundary/space_time_value.hpp"

namespace couplet::flow {

/// Taylor-Green vortices. In two dimensions they decay as exp(-2 nu t / L^2) and nothing else changes; in three
/// dimensions the formula is the usual start of a run and holds at t = 0 only.
struct TaylorGreenVortices {
  double velocity = 1;  // V [m/s]
  double length = 1;    // L [m]
  int n_dimensions = 3;
};

/// C. R. Ethier, D. A. Steinman, "Exact fully 3D Navier-Stokes solutions for benchmarking", Int. J. Numer. Meth. Fluids
/// 19 (1994) 369-375, with velocities in units of 1 m^2/s times a.
struct EthierSteinmanFlow {
  double a = 0.7853981633974483, d = 1.5707963267948966;  // [1/m]
};

class ExactFlow {
 public:
  ExactFlow(std::variant<TaylorGreenVortices, EthierSteinmanFlow> solution, double density, double viscosity);

  Point velocity(const Point& x, double t) const;   // [m/s]
  double pressure(const Point& x, double t) const;  // [Pa], with an arbitrary constant

  VectorValue velocity_value() const;
  SpaceTimeValue pressure_value() const;

 private:
  std::variant<TaylorGreenVortices, EthierSteinmanFlow> solution_;
  double density_;
  double kinematic_viscosity_;  // nu [m^2/s]
};

}  // namespace couplet::flow
