#pragma once
// The ghost value beside a border on which a tangential velocity is given.

#include <algorithm>

namespace couplet::flow {

/// ghost = border * u_border + first * u_0 + second * u_1, u_0 and u_1 being the two values next to the border.
struct GhostWeights {
  double border = 0, first = 0, second = 0;
};

/// The ghost stands one width of the first cell from u_0. It is chosen so that (u_0 - ghost) / width is the slope of
/// the parabola through u_border, u_0 and u_1, taken where inner fluxes are exact for parabolas: half way between the
/// centres, (next - width) / 4 from the border were the spacing to go on linearly beyond it. So the diffusion of a
/// parabola is exact up to the border where widths are equal or change linearly.
inline GhostWeights parabolic_ghost(double width, double next_width) {
  const double a = 0.5 * width, b = width + 0.5 * next_width;  // places of u_0 and u_1
  const double s = 0.25 * std::clamp(next_width - width, -width, width);
  // q(y) = q_b + [q_0 - q_b] y (y - b) / (a (a - b)) + [q_1 - q_b] y (y - a) / (b (b - a)); q'(s):
  const double slope_first = (2 * s - b) / (a * (a - b)), slope_second = (2 * s - a) / (b * (b - a));
  return {width * (slope_first + slope_second), 1 - width * slope_first, -width * slope_second};
}

/// Where there is one cell only: the straight line.
inline GhostWeights linear_ghost() {
  return {2, -1, 0};
}

}  // namespace couplet::flow
