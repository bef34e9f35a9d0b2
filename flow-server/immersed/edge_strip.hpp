#pragma once
// A thin sheet and the strip beyond its free edges, across which it opens to the fluid.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/moving_point.hpp"
#include "flow-server/immersed/surface_topology.hpp"

namespace couplet::flow {

/// How a sheet opens across its free edge. Lengths in cell widths.
struct EdgeRamp {
  double length = 2;       // over which it opens
  double shift = 0.13;     // by which the middle of the ramp lies beyond the edge
  double past = 1.5;       // that the strip goes on where it is fully open
  double shut_from = 0.1;  // of what stands before the edge: there it begins to shut, and at contact it is closed

  double beyond() const { return length / 2 + shift + past; }  // the edge, up to where the strip ends
  double before() const { return length / 2 - shift; }         // the edge, from where it begins to open

  /// o(s) = max(1/2 + (s/h - shift) / length, 0); s: distance beyond the edge, negative on the sheet; h: width of a
  /// cell [m]. Goes on above 1 where the strip is fully open, up to 1 + past / length at its end, so that it is linear
  /// in the triangles of the strip: what is read between their corners is cut off at 1 (BodySurface::opening).
  double opening(double s, double h) const;
};

/// Prolongs a sheet tangentially beyond its free edges by beyond() cells, with `opening` rising across them, so that an
/// edge that moves through the grid switches no cell from closed to open at once. The last `past` cells of the strip
/// are fully open: a cell in which the strip ends, which is parted on one side and one on the other, then lies where
/// there is nothing to part, and the noise of a freely moving edge halves. Edges that are attached to a wall go on
/// beyond it by a given length, as open as the sheet is beside them.
///
/// A convex corner of the edge gets a fan of triangles. Before a concave one, and where another free edge of the same
/// sheet lies near, the strips end on the line midway, with the opening that they have there. Velocities are the exact
/// rates of the positions (cell widths and those shortened reaches held): the strip turns and stretches with the
/// triangles of its edge, and what it sweeps is what its velocities say. The edge's own velocity would leave a defect
/// of rotation rate times reach. In a rigid motion of the sheet the strip moves with it.
///
/// On the sheet the opening is linear in each triangle, so triangles within before() cells of a free edge should be no
/// larger than half a cell: choose the size of the tessellation so.
class EdgeStrip {
 public:
  using CellWidth = std::function<double(const Point&)>;  // [m]
  /// How far an obstacle stands before a point of the edge, in the direction in which the strip goes on (a unit vector)
  /// [m]; 0 where they touch.
  using Clearance = std::function<double(const Point& from, const Point& direction)>;

  /// Settles which triangles there are, from the sheet as it is now; `is_attached` says so for each free edge. Which
  /// corners of the sheet an edge opens, and which edges are near each other, is searched up to twice the distance that
  /// counts now.
  EdgeStrip(const BodySurface& sheet, std::span<const FreeEdge> free_edges, const std::vector<bool>& is_attached,
            const EdgeRamp& ramp, double attached_length, const CellWidth& cell_width);

  /// Follows the sheet, which has the corners and triangles that the strip was made from. With a clearance edges shut
  /// before obstacles: the opening falls linearly with it from shut_from cells on.
  void update(const BodySurface& sheet, const CellWidth& cell_width, const Clearance& clearance = {});

  /// The sheet's corners and triangles first, then those of the strip.
  const BodySurface& surface() const { return surface_; }
  int n_sheet_corners() const { return n_sheet_corners_; }
  int n_sheet_triangles() const { return n_sheet_triangles_; }

  /// Carries forces on the strip's corners to those of the sheet that move them: the transpose of how velocities
  /// follow, so that sum and work are kept. Takes one force for each corner of surface(), leaves one for each of the
  /// sheet.
  void gather(std::vector<Point>& force) const;

 private:
  /// A side of one triangle. `inner` is the third corner of that triangle.
  struct Edge {
    int from, to, inner;
  };
  /// A corner of the border from which corners of the strip go out.
  struct Root {
    int corner;
    int in = -1, out = -1;  // edges that end and start here; -1: none
    int first = 0, n = 1;   // its corners in the strip: [first, first + n), from the side of `in` to that of `out`
    int along = -1;         // attached roots: the corner before this one on the free edge that ends here; -1: none
    bool is_attached = false;
    std::vector<int> nearby;  // other edges that its strip must not cross
  };
  struct NearEdge {
    int corner, edge;
  };

  void add_strip(std::span<const int> edges, bool is_attached);
  void add_roots(std::span<const int> edges, bool is_attached);
  std::vector<int> continue_beyond_walls(std::span<const int> free);
  void find_nearby_edges(std::span<const int> edges, const CellWidth& cell_width);
  void find_opened_corners(std::span<const int> edges, const CellWidth& cell_width);
  const Point& position(int corner) const { return surface_.position[static_cast<std::size_t>(corner)]; }
  double distance_to(int edge, const Point& point) const;
  double turn(const Root& root) const;
  double concave_limit(const Root& root) const;
  double free_reach(const Root& root, const Point& direction, double reach) const;
  void place(const Root& root, const CellWidth& cell_width);
  void shut(const CellWidth& cell_width, const Clearance& clearance);

  template <class At>
  MovingPoint outward(int edge, const At& at) const;
  template <class At>
  std::vector<MovingPoint> directions(const Root& root, const At& at) const;

  EdgeRamp ramp_;
  double attached_length_;
  int n_sheet_corners_, n_sheet_triangles_;
  BodySurface surface_;
  std::vector<Edge> edge_;
  std::vector<Root> root_;      // attached ones first: the others may hang on their corners
  std::vector<double> reach_;   // of each strip corner [m]
  std::vector<double> ajar_;    // of each corner: 1, and less on an edge near an obstacle, a factor of openings
  std::vector<NearEdge> near_;  // corners of the sheet and the edges that may open them
};

}  // namespace couplet::flow
