#pragma once
// The one-dimensional elastic tube on which couplers are measured: a flow whose wall answers the pressure at once.

#include <Eigen/Core>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::oracle {

/// Inviscid quasi-one-dimensional flow of density 1 through a tube of length 10 with rest area 1 and rest velocity 10
/// [Degroote, Bruggeman, Haelterman, Vierendeels 2008], nodes 0 ... n_cells.
struct ElasticTube {
  double young_modulus = 1e4;
  int n_cells = 100;
  double length = 10;

  double cell() const { return length / n_cells; }
  double wave_speed_squared() const;  // c^2 = E sqrt(pi) / 2
  double inlet_velocity(double time) const;
  Eigen::VectorXd wall_area(const Eigen::VectorXd& pressure) const;  // a = (2 c^2)^2 / (p - 2 c^2)^2
};

struct TubeFlowState {
  Eigen::VectorXd velocity, pressure, area;  // (n_cells + 1)

  surface::NodeArray columns() const;
  static TubeFlowState from_columns(const surface::NodeArray& columns);
};

TubeFlowState rest_state(const ElasticTube& tube);

/// Velocity and pressure at the end of the step, for a given area there. Continuity and momentum on nodes 1 ... n - 1
/// with first order upwinding, a non-reflecting outlet; Newton down to round-off. The result is not finite when Newton
/// fails.
TubeFlowState solve_tube_flow(const ElasticTube& tube, const TubeFlowState& old, const Eigen::VectorXd& area,
                              double end_time, double duration);

}  // namespace couplet::oracle
