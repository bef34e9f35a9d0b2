#include "flow-server/poisson/solve_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::flow {

using report::text;

void refuse_unless_finite(double norm) {
  if (std::isfinite(norm)) return;
  throw report::NumericsError("pressure", "the norm of the residual is " + text(norm) + " before the first iteration",
                              "a velocity or a pressure is not a number; take a smaller time step");
}

void refuse_residual(double residual, double at_start, int iterations, double wanted) {
  throw report::NumericsError(
      "pressure",
      "the residual does not fall: " + text(residual) + " after " + std::to_string(iterations) + " iterations, " +
          text(at_start) + " at the start, wanted " + text(wanted),
      "take a smaller time step, or a looser pressure tolerance where the wanted residual is near round-off");
}

void refuse_iterations(double residual, int iterations, double wanted) {
  throw report::NumericsError("pressure",
                              "the residual is " + text(residual) + " after " + std::to_string(iterations) +
                                  " iterations, wanted " + text(wanted),
                              "allow more iterations, or a looser pressure tolerance");
}

double rounded_mean(double mean, double norm) {
  if (!(norm > 0) || !std::isfinite(norm)) return mean;
  const double unit = std::ldexp(1.0, std::ilogb(norm) - 46);
  return std::round(mean / unit) * unit;
}

void clear_ghosts_beyond_borders(const BlockDecomposition& decomposition, Field<double>& field) {
  if (!decomposition.has_cells()) return;
  const Box all = box_of(field.sizes()).grown(field.ghosts());
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!decomposition.is_at_border(d, side)) continue;
      Box beyond = all;
      (side == 0 ? beyond.end[d] : beyond.begin[d]) = side == 0 ? 0 : field.sizes()[d];
      for (int k = beyond.begin[2]; k < beyond.end[2]; ++k)
        for (int j = beyond.begin[1]; j < beyond.end[1]; ++j)
          std::fill(field.row(j, k) + beyond.begin[0], field.row(j, k) + beyond.end[0], 0.0);
    }
}

}  // namespace couplet::flow
