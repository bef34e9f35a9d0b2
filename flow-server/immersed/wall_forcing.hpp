#pragma once
// The velocities that walls impose on a predicted velocity.

#include <functional>

#include "flow-server/immersed/body_geometry.hpp"

namespace couplet::flow {

/// Collective. Fills four layers of ghosts, those beyond borders too, of a velocity and, unless null, of something that
/// changes it. Images near a border stand between the faces inside and those beyond it, beside a neighbour in its own.
using FillGhosts = std::function<void(VectorField& velocity, VectorField* change)>;

/// A predicted velocity u* = u^ - (dt / rho) g, where g is the slope of some pressure: near walls both are known, so
/// that the slope can be exchanged for that of another pressure. What walls impose holds at the end of the step, when
/// the whole gradient has acted: the wall value of u^ is U_wall + (dt / rho) g, with g from the image point. So the
/// pressure that the projection finds does not depend on the one that u* was predicted with, and the slip that is left
/// at walls is of second order in the step.
class WallForcing {
 public:
  explicit WallForcing(const FlowBlock& block);

  /// In a velocity that took the slope of the pressure between the middles of cells, for `step_over_density` = dt / rho
  /// [s m^3/kg]: cut faces between places on different sides of a wall get that of their own side. `before`: the bodies
  /// whose pressure of pieces goes with `pressure`, that of the cells.
  void mend_slopes(const BodyGeometry& before, double step_over_density, const Field<double>& pressure,
                   VectorField& velocity) const;

  /// Collective. Forces the predicted `velocity` of faces near the walls of `now`. `before`: the bodies at the start of
  /// the step, whose pressure of pieces goes with `pressure`, that of the cells, ghosts of four layers filled.
  /// Notes in `now` which faces have changed sides; these take nothing of what was predicted for them.
  void force(const BodyGeometry& before, BodyGeometry& now, const Field<double>& pressure,
             const FillGhosts& fill_ghosts, VectorField& velocity);

  /// Collective. Forces the velocity of a stage inside a step, when `elapsed` of it (0 to 1) has passed: between what
  /// the walls impose where they are at its start and at its end. Leaves its ghosts filled.
  void hold(const BodyGeometry& before, const BodyGeometry& now, double elapsed, const FillGhosts& fill_ghosts,
            VectorField& velocity);
  /// What hold() has changed, taken back from the velocity of the next stage, which went on from the held one: so the
  /// equations are blended with the wall once a step, by every scheme.
  void release(VectorField& velocity) const;

  /// Exchanges the slopes in the velocity of faces near the walls of `now` for those of the given pressure, and leaves
  /// the velocity of each piece of cut faces with its own slope in piece_velocity().
  void take_slopes_of(BodyGeometry& now, double step_over_density, const Field<double>& pressure,
                      VectorField& velocity);

  /// (n_pieces of CutCells) velocity along the face's normal [m/s]; faces of this rank and those at its start.
  const std::vector<double>& piece_velocity() const { return piece_velocity_; }
  /// (n_walls of CutCells) of walls near a smooth free edge, as triangles: by what the flow through their open share
  /// differs from that of the velocities of the faces around [m^3/s]. Those carry the slopes of the pressure at their
  /// own places, the flow through an opening the difference between both of its sides, times its conductance. Without
  /// this a pressure that no slope knows would add up over the steps. Of walls in cells of this rank.
  const std::vector<double>& opening_flow() const { return opening_flow_; }
  /// (n_pieces of CutCells) by which the mean velocity of a piece differs from that at the middle of its face [m/s].
  const std::vector<double>& piece_shift() const { return piece_shift_; }

 private:
  /// The wall value of u* and of its slope, or what holds beside it.
  struct Imposed {
    double velocity, slope;
  };
  Imposed imposed(const WallLayer& layer, const WallValue& value, const Field<double>& velocity) const;
  /// Slopes of faces that images need beside those near walls.
  void take_slopes_of_images(const BodyGeometry& now, const Field<double>& pressure);
  double slope_of_face(const BodyGeometry& bodies, const Field<double>& pressure, int d, const Triple& face) const;
  void find_opening_flow(const BodyGeometry& now, double step_over_density, const Field<double>& pressure);
  bool is_mine(int d, const Triple& face) const;

  const FlowBlock& block_;
  VectorField slope_;                  // g on faces near walls and those of images [Pa/m]
  std::vector<double> share_;          // (n_forced) of the wall value
  std::vector<Imposed> left_, fresh_;  // (n_forced) to the equations; of a round
  std::vector<Imposed> ghost_;
  struct HeldFace {
    int component;
    Triple face;
    double change;  // [m/s]
  };
  std::vector<HeldFace> held_;  // of this rank
  std::vector<double> piece_velocity_, piece_shift_, opening_flow_;
};

}  // namespace couplet::flow
