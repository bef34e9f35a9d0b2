#pragma once
// The velocities that walls impose on a predicted velocity.

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/immersed/body_geometry.hpp"

namespace couplet::flow {

/// A predicted velocity u* = u^ - (dt / rho) g, where g is the slope of some pressure: near walls both are known, so
/// that the slope can be exchanged for that of another pressure. What walls impose holds at the end of the step, when
/// the whole gradient has acted: the wall value of u^ is U_wall + (dt / rho) g, with g from the image point. So the
/// pressure that the projection finds does not depend on the one that u* was predicted with, and the slip that is left
/// at walls is of second order in the step.
class WallForcing {
 public:
  explicit WallForcing(const FlowBlock& block);

  /// Collective. Forces the predicted `velocity` of faces near the walls of `now`. `before`: the bodies at the start of
  /// the step, whose pressure of pieces goes with `pressure`, that of the cells, ghosts of four layers filled.
  /// Notes in `now` which faces have changed sides; these take nothing of what was predicted for them.
  /// `step_over_density`: dt / rho [s m^3/kg].
  void force(const BodyGeometry& before, BodyGeometry& now, double step_over_density, const Field<double>& pressure,
             HaloExchange& halo, VectorField& velocity);

  /// Collective. Forces the velocity of a stage inside a step, with the walls where they are at its start.
  void hold(const BodyGeometry& before, HaloExchange& halo, VectorField& velocity) const;

  /// Exchanges the slopes in the velocity of faces near the walls of `now` for those of the given pressure, and leaves
  /// the velocity of each piece of cut faces with its own slope in piece_velocity().
  void take_slopes_of(BodyGeometry& now, double step_over_density, const Field<double>& pressure,
                      VectorField& velocity);

  /// (n_pieces of CutCells) velocity along the face's normal [m/s]; faces of this rank and those at its start.
  const std::vector<double>& piece_velocity() const { return piece_velocity_; }
  /// (n_pieces of CutCells) by which the mean velocity of a piece differs from that at the middle of its face [m/s].
  const std::vector<double>& piece_shift() const { return piece_shift_; }

 private:
  /// The wall value of u* and of its slope.
  struct Imposed {
    double velocity, slope;
  };
  Imposed imposed(const BodyGeometry& now, const WallValue& value, const Field<double>& pressure,
                  const Field<double>& velocity) const;
  /// The mean of the faces beside a place instead, where a gap leaves no room for the wall value.
  Imposed mixed(const Imposed& wall, double room, const std::vector<Triple>& beside, int component,
                const VectorField& velocity) const;
  double slope_between_cells(const Field<double>& pressure, int d, const Triple& face) const;
  double slope_of_face(const BodyGeometry& bodies, const Field<double>& pressure, int d, const Triple& face) const;
  bool is_mine(int d, const Triple& face) const;
  std::vector<Triple> seen_beside(const BodyGeometry& now, const WallValue& value) const;

  const FlowBlock& block_;
  VectorField slope_;  // g on faces near walls [Pa/m]
  std::vector<Imposed> ghost_;
  std::vector<double> piece_velocity_, piece_shift_;
};

}  // namespace couplet::flow
