#pragma once
// What bodies change in a step of the flow: its story stands in navier_stokes/.

#include <functional>
#include <memory>
#include <optional>

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/immersed/wall_forcing.hpp"

namespace couplet::flow {

/// The bodies in a flow, at the start and at the end of a step.
class ImmersedBodies {
 public:
  /// All must outlive this.
  ImmersedBodies(const FlowBlock& block, const BodyFlowSettings& settings);

  /// Of a new state.
  std::shared_ptr<BodyGeometry> make_geometry(std::vector<BodySurface> surfaces) const;

  /// Collective. The pressure problem of a position of the bodies; tells where shares have changed since the last call.
  /// Returns false where the problem is on all ranks what it was: nothing has moved.
  bool write_problem(const BodyGeometry& now, PressureProblem& problem, std::vector<Box>& changed);

  /// The next position may lie anywhere: after a restart.
  void expect_jump() { follows_last_ = false; }

  /// A pressure for the pieces of `now` from that of `before`, and for those cells near walls whose place in the fields
  /// has come to belong to another part. Writes `guess` near walls only; elsewhere it is that of `pressure`.
  void carry_pressure(const BodyGeometry& before, const Field<double>& pressure, BodyGeometry& now,
                      Field<double>& guess) const;

  /// Collective. The pressure of further pieces in ghost layers from the ranks that own their cells: four layers, so
  /// that all ranks carry the same pressure to the pieces of the next step.
  void fill_piece_ghosts(HaloExchange& halo, BodyGeometry& now);

  /// source = factor * div velocity in cut cells, of their places in the fields and of further pieces (n_listed).
  void take_divergence(const BodyGeometry& now, double factor, const VectorField& velocity,
                       const std::vector<double>& piece_velocity, Field<double>& source,
                       std::vector<double>& piece_source) const;

  /// Velocities of cut faces whose two sides are not the cells' places: to be kept before a sweep takes slopes between
  /// cells, and corrected after it.
  void keep_cut_faces(const BodyGeometry& now, const VectorField& velocity);
  void correct_cut_faces(const BodyGeometry& now, double step_over_density, const Field<double>& phi,
                         const std::vector<double>& piece_phi, VectorField& velocity) const;

  /// No flow and no pressure deep inside bodies: nothing holds there what the equations of the fluid make of it.
  /// `whole`: CutCells::whole() of the fluid cells of this rank.
  void still_inside(const BodyGeometry& now, const ActiveCells& whole, VectorField& velocity,
                    Field<double>& pressure) const;

  /// Largest sum over directions of the wall's speed over the cell's width, in cells of this rank [1/s].
  double courant_rate(const BodyGeometry& bodies) const;

  WallForcing& forcing() { return forcing_; }

 private:
  bool is_of_my_cells(int d, const Triple& face) const;

  const FlowBlock& block_;
  BodyFlowSettings settings_;
  WallForcing forcing_;
  std::vector<PressurePieces::FaceShare> written_;
  bool follows_last_ = false;  // the next position from that which was written last, by one cell at most
  std::vector<double> kept_;
  std::vector<Field<double>> exchanged_;  // the first, second, ... further piece of each cell
};

}  // namespace couplet::flow
