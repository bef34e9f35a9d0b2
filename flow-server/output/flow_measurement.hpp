#pragma once
// Numbers measured in a flow: integrals, planes, points. Each rank measures its own cells; sums over ranks are left to
// the caller, so that all numbers of a step travel together.

#include <string>
#include <vector>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/flow_state.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/output/exact_flow.hpp"
#include "flow-server/output/velocity_gradient.hpp"

namespace couplet::flow {

/// What a rank knows about its own part.
struct FlowPart {
  const StretchedGrid& grid;
  const BlockDecomposition& decomposition;
  const ActiveCells& active;
  const FlowState& state;  // ghosts filled

  const Triple& origin() const { return decomposition.mine().begin; }
};

/// Share of the volume of a cell, local indices, that holds fluid: 0 inside bodies and in cells that are not active;
/// of cut cells that of their fluid parts.
double fluid_share(const FlowPart& part, const Triple& cell);

/// Sums over all cells that hold fluid; cells that surfaces cut count by their share of it.
struct IntegralQuantities {
  double kinetic_energy = 0;  // rho / 2 integral of u^2, on the faces where the components stand [J]
  double dissipation = 0;     // mu integral of 2 S : S [W]
  double enstrophy = 0;       // 1/2 integral of |curl u|^2 [m^3/s^2]
};
/// Diagonal rates of strain stand at cell centres, the others at edges: all from neighbouring faces, so that no
/// interpolation smears small vortices.
IntegralQuantities integrate(const FlowPart& part, double density, double viscosity);

/// A plane normal to an axis, or the part of it inside a box.
struct PlaneCut {
  std::string name;
  int direction = 0;
  double position = 0;  // [m]
  Point from, to;       // box; the direction of the normal does not count
};
struct PlaneRates {
  double flow_rate = 0;      // integral of u_n [m^3/s]
  double momentum_flux = 0;  // rho integral of u_n^2 [N]
};
/// u_n is linear between the two faces around the plane; cells that the box cuts count by their share, and so do faces
/// that bodies cut.
PlaneRates integrate(const FlowPart& part, const PlaneCut& plane, double density);

struct PointProbe {
  std::string name;
  Point position;  // [m]
};
struct PointValue {
  Vector3 velocity{0, 0, 0};
  double pressure = 0;
};
/// Linear in every direction between the places where each component stands. Zero on ranks that do not own the cell
/// around the point.
PointValue measure(const FlowPart& part, const PointProbe& probe);

/// Squares and largest value of the distance from an exact solution, over the cells and faces that hold fluid and that
/// no body cuts.
struct ErrorSums {
  double velocity_square = 0;                // integral of |u - u_exact|^2 [m^5/s^2]
  double pressure = 0, pressure_square = 0;  // integrals of p - p_exact and of its square
  double volume = 0;                         // [m^3]
  double largest_velocity = 0;               // [m/s]
};
ErrorSums compare(const FlowPart& part, const ExactFlow& exact);

}  // namespace couplet::flow
