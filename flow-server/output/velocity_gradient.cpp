#include "flow-server/output/velocity_gradient.hpp"

#include <cmath>

namespace couplet::flow {

double CellVelocity::component(int a, const Triple& cell) const {
  const Field<double>& u = state_.velocity[a];
  Triple before = cell;
  --before[a];
  return 0.5 * (u(before[0], before[1], before[2]) + u(cell[0], cell[1], cell[2]));
}

Vector3 CellVelocity::at(const Triple& cell) const {
  Vector3 u{0, 0, 0};
  for (int a = 0; a < grid_.n_dimensions; ++a) u[a] = component(a, cell);
  return u;
}

Tensor3 CellVelocity::gradient(const Triple& cell) const {
  Tensor3 gradient{};
  for (int b = 0; b < grid_.n_dimensions; ++b) {
    const StretchedAxis& axis = grid_.axis[b];
    const int i = origin_[b] + cell[b];
    Triple before = cell, after = cell;
    --before[b];
    ++after[b];
    const double h1 = axis.distance(i - 1), h2 = axis.distance(i);
    for (int a = 0; a < grid_.n_dimensions; ++a) {
      if (a == b) {
        const Field<double>& u = state_.velocity[a];
        gradient[a][a] = (u(cell[0], cell[1], cell[2]) - u(before[0], before[1], before[2])) / axis.width(i);
        continue;
      }
      const double here = component(a, cell);
      // Derivative of the parabola through three unequally spaced points.
      gradient[a][b] = (h1 / h2 * (component(a, after) - here) + h2 / h1 * (here - component(a, before))) / (h1 + h2);
    }
  }
  return gradient;
}

Vector3 vorticity(const Tensor3& g) {
  return {g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]};
}

double q_criterion(const Tensor3& g) {
  // |Omega|^2 - |S|^2 = -sum_ab g_ab g_ba
  double sum = 0;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) sum += g[a][b] * g[b][a];
  return -0.5 * sum;
}

double swirling_strength(const Tensor3& g) {
  // lambda^3 - tr lambda^2 + m lambda - det = 0, with m the sum of the principal minors.
  const double tr = g[0][0] + g[1][1] + g[2][2];
  const double m = g[0][0] * g[1][1] - g[0][1] * g[1][0] + g[0][0] * g[2][2] - g[0][2] * g[2][0] + g[1][1] * g[2][2] -
                   g[1][2] * g[2][1];
  const double det = g[0][0] * (g[1][1] * g[2][2] - g[1][2] * g[2][1]) -
                     g[0][1] * (g[1][0] * g[2][2] - g[1][2] * g[2][0]) +
                     g[0][2] * (g[1][0] * g[2][1] - g[1][1] * g[2][0]);
  // With lambda = s + tr / 3: s^3 + p s + q = 0 (Cardano).
  const double p = m - tr * tr / 3;
  const double q = -2 * tr * tr * tr / 27 + tr * m / 3 - det;
  const double discriminant = 0.25 * q * q + p * p * p / 27;
  if (!(discriminant > 0)) return 0;
  // The root without cancellation first; the other follows from their product -p / 3.
  const double large = std::cbrt(-0.5 * q - std::copysign(std::sqrt(discriminant), q));
  const double small = large == 0 ? 0 : -p / (3 * large);
  return 0.5 * std::sqrt(3.0) * std::abs(large - small);
}

}  // namespace couplet::flow
