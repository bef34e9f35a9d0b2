#pragma once
// An exact solution of the Navier-Stokes equations.

#include <cmath>
#include <numbers>

#include "flow-server/boundary/space_time_value.hpp"

namespace couplet::flow::oracle {

/// C. R. Ethier, D. A. Steinman, Exact fully 3D Navier-Stokes solutions for benchmarking, Int. J. Numer. Meth. Fluids
/// 19 (1994) 369-375; density 1, a = pi/4, d = pi/2.
struct EthierSteinman {
  double viscosity = 0.1;  // kinematic [m^2/s]

  static constexpr double a = std::numbers::pi / 4, d = std::numbers::pi / 2;
  double decay(double t) const { return std::exp(-viscosity * d * d * t); }

  double velocity(int component, const Point& point, double t) const {
    // The components are each other's under cyclic change of x, y, z.
    const double x = point[component], y = point[(component + 1) % 3], z = point[(component + 2) % 3];
    return -a * (std::exp(a * x) * std::sin(a * y + d * z) + std::exp(a * z) * std::cos(a * x + d * y)) * decay(t);
  }
  double pressure(const Point& point, double t) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      const double x = point[c], y = point[(c + 1) % 3], z = point[(c + 2) % 3];
      sum += std::exp(2 * a * x) + 2 * std::sin(a * x + d * y) * std::cos(a * z + d * x) * std::exp(a * (y + z));
    }
    return -0.5 * a * a * sum * decay(t) * decay(t);
  }
};

}  // namespace couplet::flow::oracle
