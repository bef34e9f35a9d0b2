#pragma once
// Free vibration about a given displacement.

#include <array>
#include <vector>

#include "solid-server/assembly/tangent_solver.hpp"

namespace couplet::solid {

struct Mode {
  double frequency = 0;   // [Hz]; below 0: the body is not stable there, and the motion grows by exp(2 pi |f| t)
  double eigenvalue = 0;  // (2 pi f)^2 [1/s^2], with the sign of f
  NodeVectors shape;      // phi, (n_nodes, 4), phi^T M phi = 1 [1/sqrt(kg)]; the largest component is above 0
  std::array<double, 3> direction_share{};  // of x, y, z in phi^T M phi, 1 in all
  double residual = 0;                      // |K phi - lambda M phi| over |K phi|, both with the shift
};

/// The lowest modes of K(u) phi = lambda M phi, rising. Shift-inverted Lanczos iteration with restarts [Lehoucq,
/// Sorensen, Yang 1998], by Spectra. The shift lies a little below all eigenvalues, so that a body that is not held has
/// its six modes of frequency 0 too. One start vector may miss copies of equal eigenvalues; so the lowest of what is
/// left beside the modes found is looked for from another one, until it is not among the lowest.
///
/// Throws SceneError when there are not as many modes; NumericsError when the body is turned inside out at the
/// displacement or the iteration does not converge. Uses up what `solver` has assembled.
std::vector<Mode> modal_analysis(TangentSolver& solver, const NodeVectors& displacement, int n_modes);

}  // namespace couplet::solid
