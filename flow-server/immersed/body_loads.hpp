#pragma once
// The force of the fluid on the surfaces in it.

#include <span>
#include <vector>

#include "flow-server/grid/flow_state.hpp"
#include "flow-server/immersed/body_geometry.hpp"

namespace couplet::flow {

struct SurfaceLoad {
  std::vector<Point> corner_force;  // (n_corners) of pressure and viscous stress together [N]
  Point pressure_force{};           // sums over all corners; with the reaction to imposed momentum [N]
  Point viscous_force{};
};

/// Sum of x_c - point cross F_c [N m].
Point moment_about(const Point& point, const BodySurface& surface, std::span<const Point> corner_force);

/// Pressure. The projection counts (1 - o) W of each triangle of the wall as flow out of the cells on one side into
/// those on the other, W = (mean of the velocities at its three points) . area. Forces are the transpose of that with
/// the pressure of the parts on both sides: for any velocities of the corners
///     sum over corners of F . U = sum over walls of (p_inner - p_outer) (1 - o) W
/// to round-off, so that the work done on a body is what leaves the fluid. A body that is solid inside has no inner
/// pressure.
///
/// Viscous stress, on each fluid side of the wall with the normal m into the fluid:
///     t = mu (grad u + grad u^T) m = mu (g_t - 2 m div_s U + (grad_s U)^T m)
/// g_t: tangential part of du/dm; grad_s U, div_s U: derivatives of the wall's own velocity along it. At a no-slip wall
/// nothing is left out: the fluid's derivatives along the wall are the wall's, and du_m/dm = -div_s U as div u = 0. The
/// last term matters for walls that turn: it takes away what the fluid does that turns along with them.
/// du/dm is one-sided, from the wall and trilinear interpolations at two points along m, of faces that see this side:
///     sum of w_i (u_i - U_i) = g sum of w_i xi_i + q / 2 sum of w_i xi_i^2
/// for both points, with each face's own distance xi_i from the curved wall: neither the faces that are missing behind
/// the wall nor what interpolation makes of a bent profile spoils the second order.
class BodyLoads {
 public:
  /// The block must outlive this. `viscosity`: dynamic [Pa s].
  BodyLoads(const FlowBlock& block, double viscosity) : block_(block), viscosity_(viscosity) {}

  /// Collective. On each surface, the same on all ranks. One sum of 24 bytes a corner over all ranks: 2.4 MB for 1e5
  /// corners, whatever the number of ranks.
  /// Pressure, the reaction to what walls impose (imposed_momentum.hpp) and viscous stress. `density` [kg/m^3].
  std::vector<SurfaceLoad> measure(const FlowState& state, double density) const;

  /// Of the walls in cells of this rank alone.
  void add_pressure(const BodyGeometry& bodies, const Field<double>& pressure, std::vector<SurfaceLoad>& loads) const;
  /// Reads four ghost layers of the velocity.
  void add_viscous_stress(const BodyGeometry& bodies, const VectorField& velocity,
                          std::vector<SurfaceLoad>& loads) const;

  /// No force on the corners of these surfaces.
  static std::vector<SurfaceLoad> no_loads(std::span<const BodySurface> surfaces);

 private:
  struct WallPatch;
  void find_bend(const BodyGeometry& bodies, const Eigen::Vector3d& normal, double size, WallPatch& patch) const;
  Eigen::Vector3d normal_derivative(const BodyGeometry& bodies, const VectorField& velocity, const WallPatch& patch,
                                    const Eigen::Vector3d& normal, double size, int part) const;

  const FlowBlock& block_;
  double viscosity_;
};

}  // namespace couplet::flow
