#pragma once
// x^(-1/3), as the isochoric invariants need it at every point: right for every x > 0, fast near 1.

#include <cmath>

#include "solid-server/material/pack.hpp"

namespace couplet::solid {

inline double inverse_cube_root(double x) {
  return 1 / std::cbrt(x);
}

/// Between 0.5 and 2: a polynomial start and two steps of y <- y (1 - e)^(-1/3) as a series in e = 1 - x y^3; the first
/// step keeps three terms, the second one, which leaves an error of round-off. Elsewhere: lane by lane.
[[gnu::always_inline]] inline Pack inverse_cube_root(const Pack& x) {
  if (!all_true((x > 0.5) & (x < 2.0))) [[unlikely]] {
    Pack y{};
    for (int lane = 0; lane < n_lanes; ++lane) y[lane] = inverse_cube_root(x[lane]);
    return y;
  }
  // Chebyshev interpolation of x^(-1/3) on [0.5, 2], degree 5, as a polynomial in s = (x - 1.25) / 0.75.
  const Pack s = (x - 1.25) * (1 / 0.75);
  Pack y = 0.92856995089182315 +
           s * (-0.18580211123544829 +
                s * (0.069803054670341869 +
                     s * (-0.032206245675781633 + s * (0.02807266028251269 + s * (-0.014899780524673853)))));
  Pack e = 1.0 - x * y * y * y;
  y += y * e * (1.0 / 3 + e * (2.0 / 9 + e * (14.0 / 81)));
  e = 1.0 - x * y * y * y;
  return y + y * e * (1.0 / 3);
}

}  // namespace couplet::solid
