#pragma once
// Where surfaces cross the edges of cells, and where their sharp edges cross faces: all that the flow knows of their
// shape.

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "flow-server/grid/active_cells.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/face_bends.hpp"

namespace couplet::flow {

struct EdgeCrossing : SurfacePoint {
  double share = 0;        // of the edge before it, between 0 and 1, never either
  bool leads_out = false;  // going along the axis: from the inner to the outer side
};

/// Edges of the cells of a block and some layers around it. Edge (d, i, j, k) runs along direction d from the corner
/// at which the cell (i, j, k) starts in all directions, local indices. A line through two triangles that share an edge
/// meets exactly one of them, and the three lines through a corner of a cell agree on which side of a triangle it lies:
/// so a watertight surface gives closed chains of crossings. Surfaces are moved by 1e-9 of a cell in a fixed direction,
/// so that edges and corners that lie in them exactly are none of these cases.
///
/// In two dimensions all is seen in the middle plane, and the edges at both ends of a cell along z are the same.
class EdgeCrossings {
 public:
  /// `mine`: cells of this rank in indices of the whole; `layers` around it are looked at, as far as the grid goes.
  EdgeCrossings(const StretchedGrid& grid, const Box& mine, int layers);

  /// All surfaces, at their present place.
  void update(std::span<const BodySurface> surfaces);

  const Box& cells() const { return cells_; }  // looked at, local indices
  /// In rising order; empty outside the cells looked at.
  std::span<const EdgeCrossing> on_edge(int d, const Triple& corner) const;
  /// Of the face normal to d whose corner with the smallest coordinates is given.
  std::span<const FaceBend> bends_in_face(int d, const Triple& corner) const { return bends_.in_face(d, corner); }
  /// Whether a corner of the cells looked at lies inside a closed surface.
  bool is_inside(const Triple& corner) const;
  /// Corners inside closed surfaces of a line along x.
  std::span<const Interval> inside(int j, int k) const;
  /// Edges with crossings as (direction, corner), each once.
  struct Edge {
    int direction;
    Triple corner;
  };
  const std::vector<Edge>& crossed() const { return crossed_; }

  double position(int d, int corner) const { return corners_[d][static_cast<std::size_t>(corner - cells_.begin[d])]; }
  Eigen::Vector3d position(const Triple& corner) const {
    return {position(0, corner[0]), position(1, corner[1]), position(2, corner[2])};
  }

 private:
  struct Found {
    std::size_t edge;
    EdgeCrossing crossing;
  };
  struct Order {
    std::size_t edge;
    int found;
  };
  /// A passage through a closed surface along a line in x: `corner` is the first corner behind it.
  struct Passage {
    std::size_t line;
    int corner;
    int change;  // +1 into the body or the lumen, -1 out of it
    bool is_lumen;
  };
  void add_triangle(const BodySurface& surface, int surface_index, int triangle, const Eigen::Vector3d& shift);
  void cross_lines(const BodySurface& surface, int surface_index, int triangle,
                   const std::array<Eigen::Vector3d, 3>& vertex, int d);
  bool is_looked_at(int d, const Triple& corner) const;
  std::size_t edge_index(int d, const Triple& corner) const;
  void sort_crossings();
  void find_inside();

  const StretchedGrid& grid_;
  bool is_flat_;                                // two dimensions
  Box cells_;                                   // local
  std::array<std::vector<double>, 3> corners_;  // of the cells looked at, from begin to end included [m]
  FaceBends bends_;
  Eigen::Vector3d nudge_;                // [m]
  std::vector<Eigen::Vector3d> images_;  // shifts under which surfaces are seen in periodic directions
  std::array<Field<int>, 3> place_;      // of an edge in first_, counted from 1; 0: not crossed
  std::vector<Found> found_;
  std::vector<Order> order_;  // of found_, as they are sorted
  std::vector<EdgeCrossing> crossings_;
  std::vector<std::size_t> first_;  // (n_crossed + 1)
  std::vector<Edge> crossed_;
  std::vector<Passage> passages_;
  bool has_lumen_ = false;
  std::vector<std::vector<Interval>> inside_;  // corners inside closed surfaces, of each line along x
};

}  // namespace couplet::flow
