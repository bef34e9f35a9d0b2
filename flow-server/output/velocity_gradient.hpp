#pragma once
// What a picture of a flow is made of: velocity and its gradient at cell centres, and what follows from them.

#include <array>

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/grid/stretched_grid.hpp"

namespace couplet::flow {

using Vector3 = std::array<double, 3>;
using Tensor3 = std::array<Vector3, 3>;

/// Reads the velocity of a rank's block around a cell. `origin` is the first cell of the block in indices of the whole;
/// cells are given by local indices. Two filled ghost layers are needed for the gradient beside the block's end.
class CellVelocity {
 public:
  CellVelocity(const StretchedGrid& grid, const Triple& origin, const FlowState& state)
      : grid_(grid), origin_(origin), state_(state) {}

  /// Mean of the two faces, which have the centre in their middle.
  Vector3 at(const Triple& cell) const;
  /// gradient[a][b] = d u_a / d x_b: exact difference of the faces for a = b, second order on unequal cells otherwise.
  Tensor3 gradient(const Triple& cell) const;

 private:
  double component(int a, const Triple& cell) const;

  const StretchedGrid& grid_;
  Triple origin_;
  const FlowState& state_;
};

/// curl u
Vector3 vorticity(const Tensor3& gradient);

/// Q = (|Omega|^2 - |S|^2) / 2 with the antisymmetric and symmetric parts of the gradient; J. C. R. Hunt, A. A. Wray,
/// P. Moin, Center for Turbulence Research Report CTR-S88 (1988) 193.
double q_criterion(const Tensor3& gradient);

/// Imaginary part of the complex pair of eigenvalues of the gradient, 0 when all are real; J. Zhou, R. J. Adrian,
/// S. Balachandar, T. M. Kendall, J. Fluid Mech. 387 (1999) 353.
double swirling_strength(const Tensor3& gradient);

}  // namespace couplet::flow
