#pragma once
// Force of a pressure that varies along x on the nodes of the deformed fold.

#include <Eigen/Core>
#include <array>

#include "flow-server/one_dimensional/fold_surface.hpp"
#include "flow-server/one_dimensional/glottal_flow.hpp"
#include "flow-server/one_dimensional/quadratic_face.hpp"
#include "flow-server/one_dimensional/station_axis.hpp"

namespace couplet::flow {

/// Consistent nodal forces f_i = - integral of N_i p (dX/dr x dX/ds) dr ds over the deformed faces (a follower load),
/// by 3 x 3 Gauss points a face: exact when p is constant [ZTZ, ch. 5]. p is that of the stations, linear in
/// between, at the current x of each point: the inlet pressure upstream of the first station, the exit pressure
/// downstream of the exit line.
class PressureForce {
 public:
  PressureForce(const FoldSurface& surface, const StationAxis& axis);

  /// Writes force (n_nodes, 3) [N].
  void find(const NodePositions& moved, const GlottalSolution& flow, const EndPressures& pressures,
            surface::NodeArray& force);

 private:
  static constexpr int n_points = 9;
  struct FaceLanes {
    std::array<Lanes, 8> x, y, z;
  };
  /// p = value + slope x in interval k - 1; before the first and after the last station p is constant.
  struct PressureLine {
    double value, slope;
  };
  void find_lines(const GlottalSolution& flow, const EndPressures& pressures);
  Lanes pressure_at(const Lanes& x) const;
  FaceLanes force_on_batch(const FaceLanes& face) const;

  const FoldSurface* surface_;
  const StationAxis* axis_;
  std::array<QuadraticFacePoint, n_points> point_;
  std::array<double, n_points> weight_;
  double inlet_ = 0;                // [m]
  double fraction_per_length_ = 0;  // 1 / (exit - inlet) [1/m]
  std::vector<PressureLine> line_;  // (n_stations + 1) in xi
};

}  // namespace couplet::flow
