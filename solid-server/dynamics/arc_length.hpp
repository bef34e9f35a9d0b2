#pragma once
// A path of equilibrium followed by its arc length, through limit points of the load.

#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "solid-server/dynamics/newton.hpp"

namespace couplet::solid {

/// Equations whose loads and prescribed displacements follow one factor.
class LoadedSystem : public NonlinearSystem {
 public:
  /// Sets the factor, and the held components of u to what they are there.
  virtual void set_load(double factor, NodeVectors& u) = 0;
  /// dr/d(factor) at u [N].
  virtual NodeVectors load_rate(const NodeVectors& u) = 0;
};

struct ArcLengthControl {
  double first_load_step = 0.1;  // of the factor; the length of the first arc is that of the displacement it causes
  double longest_first_arc =
      std::numeric_limits<double>::max();  // near a limit the displacement of a load step is huge
  double longest_arc = 8;                  // over the first
  double tolerance = 1e-6;                 // |r| over the scale of the forces
  int n_iterations_wanted = 5;             // in an arc: more shorten the next, fewer lengthen it
  int n_iterations_most = 15;
  int n_halvings_most = 12;  // of the first arc, to the shortest that is tried
  int n_arcs_most = 2000;
};

/// A point of the path.
struct PathPoint {
  double load = 0;  // factor
  const NodeVectors* displacement = nullptr;
  int n_negative_pivots = 0;  // of the tangent at the point: 0 is stable
};

struct PathReport {
  bool has_reached_load = false;    // the wanted one; else a visitor ended the path, or `failure` says why
  std::string failure;              // empty: none
  std::vector<double> limit_loads;  // where the load turned, from a parabola through three points each
  int n_arcs = 0, n_iterations = 0, n_factorisations = 0;
  int n_negative_pivots = 0;  // at the last point
};

/// The cylindrical method of Crisfield (1981): the corrections of an arc keep |u - u_0| = l; of the two load factors
/// that do, the one whose displacement turns least from that before is taken. A path sets out towards growing load and
/// keeps its sense by the scalar product with the arc before (not by the sign of pivots, which also changes at
/// bifurcations). An arc must end within 60 degrees of the tangent at its start: beyond that the circle has met another
/// branch. Every correction uses new factors and the load rate at the place; an arc that does not converge is halved,
/// and the next one is as long as the number of iterations suggests. Near the wanted load the path ends there with the
/// load held.
///
/// `visit` is called at every converged point and ends the path by returning false. u and load: from a solution to the
/// last point.
PathReport follow_path(LoadedSystem& system, const ArcLengthControl& control, NodeVectors& u, double& load,
                       double wanted_load, const std::function<bool(const PathPoint&)>& visit);

}  // namespace couplet::solid
