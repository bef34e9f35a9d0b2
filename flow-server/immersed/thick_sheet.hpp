#pragma once
// A thin sheet made into a closed body of a given thickness.

#include <span>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/surface_topology.hpp"

namespace couplet::flow {

/// Both sides of a sheet, each half the thickness away from it along the mean normal of the triangles around a corner,
/// and a rim along its free edges. Where the sheet ends on a border of the grid the body does too. Velocities are the
/// exact rates of the positions. Where the sheet is bent with a radius below half the thickness its inner side folds.
class ThickSheet {
 public:
  /// Settles the triangles from the sheet as it is now. Thickness > 0 [m].
  ThickSheet(const BodySurface& sheet, const SurfaceTopology& topology, double thickness);

  /// Follows the sheet, which has the corners and triangles that the body was made from.
  void update(const BodySurface& sheet);

  /// The side that the sheet's normals point to first, corner by corner as in the sheet, then the other side.
  const BodySurface& surface() const { return surface_; }

  /// Carries forces on the body's corners to those of the sheet: the transpose of how velocities follow, so that sum
  /// and work are kept. Takes one force for each corner of surface(), leaves one for each of the sheet.
  void gather(std::vector<Point>& force) const;

 private:
  double half_thickness_;
  std::vector<std::array<int, 3>> sheet_triangle_;
  std::vector<Point> sheet_position_;
  std::vector<Point> is_free_;  // of each corner and axis: 1, or 0 for the axis of a border on which the sheet ends
  std::vector<Point> normal_;   // of each corner: sum of the areas around it, without the axes that are not free [m^2]
  BodySurface surface_;
};

}  // namespace couplet::flow
