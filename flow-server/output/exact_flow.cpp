#include "flow-server/output/exact_flow.hpp"

#include <cmath>

namespace couplet::flow {

namespace {

Point velocity_of(const TaylorGreenVortices& flow, const Point& x, double t, double nu) {
  const double L = flow.length, V = flow.velocity;
  const bool is_flat = flow.n_dimensions == 2;
  const double factor = V * (is_flat ? std::exp(-2 * nu * t / (L * L)) : std::cos(x[2] / L));
  return {factor * std::sin(x[0] / L) * std::cos(x[1] / L), -factor * std::cos(x[0] / L) * std::sin(x[1] / L), 0};
}

double pressure_of(const TaylorGreenVortices& flow, const Point& x, double t, double nu, double density) {
  const double L = flow.length, V = flow.velocity;
  const double waves = std::cos(2 * x[0] / L) + std::cos(2 * x[1] / L);
  if (flow.n_dimensions == 2) return 0.25 * density * V * V * waves * std::exp(-4 * nu * t / (L * L));
  return density * V * V / 16 * waves * (std::cos(2 * x[2] / L) + 2);
}

Point velocity_of(const EthierSteinmanFlow& flow, const Point& x, double t, double nu) {
  const double a = flow.a, d = flow.d;
  const double decay = std::exp(-nu * d * d * t);
  Point u;
  // u_m = -a (e^(a x_m) sin(a x_n + d x_l) + e^(a x_l) cos(a x_m + d x_n)), (m, n, l) a rotation of (x, y, z)
  for (int m = 0; m < 3; ++m) {
    const int n = (m + 1) % 3, l = (m + 2) % 3;
    u[m] = -a * decay *
           (std::exp(a * x[m]) * std::sin(a * x[n] + d * x[l]) + std::exp(a * x[l]) * std::cos(a * x[m] + d * x[n]));
  }
  return u;
}

double pressure_of(const EthierSteinmanFlow& flow, const Point& x, double t, double nu, double density) {
  const double a = flow.a, d = flow.d;
  double sum = 0;
  for (int m = 0; m < 3; ++m) {
    const int n = (m + 1) % 3, l = (m + 2) % 3;
    sum += std::exp(2 * a * x[m]) +
           2 * std::sin(a * x[m] + d * x[n]) * std::cos(a * x[l] + d * x[m]) * std::exp(a * (x[n] + x[l]));
  }
  return -0.5 * density * a * a * sum * std::exp(-2 * nu * d * d * t);
}

}  // namespace

ExactFlow::ExactFlow(std::variant<TaylorGreenVortices, EthierSteinmanFlow> solution, double density, double viscosity)
    : solution_(solution), density_(density), kinematic_viscosity_(viscosity / density) {}

Point ExactFlow::velocity(const Point& x, double t) const {
  return std::visit([&](const auto& flow) { return velocity_of(flow, x, t, kinematic_viscosity_); }, solution_);
}

double ExactFlow::pressure(const Point& x, double t) const {
  return std::visit([&](const auto& flow) { return pressure_of(flow, x, t, kinematic_viscosity_, density_); },
                    solution_);
}

VectorValue ExactFlow::velocity_value() const {
  VectorValue value;
  for (std::size_t d = 0; d < 3; ++d)
    value[d] = SpaceTimeValue([flow = *this, d](const Point& x, double t) { return flow.velocity(x, t)[d]; });
  return value;
}

SpaceTimeValue ExactFlow::pressure_value() const {
  return SpaceTimeValue([flow = *this](const Point& x, double t) { return flow.pressure(x, t); });
}

}  // namespace couplet::flow
