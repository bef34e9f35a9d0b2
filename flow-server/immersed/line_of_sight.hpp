#pragma once
// Which places of velocities see each other, and which surface parts them.

#include <vector>

#include "flow-server/immersed/cut_cells.hpp"

namespace couplet::flow {

/// What stands between two places: nothing where `blocked` is 0, a surface where it is 1; in between at a smooth free
/// edge. The first place is on the outer or the inner side of the surface.
struct Sight {
  double blocked = 0;
  int surface = -1;
  bool is_outer = false;
};

/// Two middles of faces see each other where they stand at the same part of each cell between them: what the flow
/// through the faces of cells knows of the surfaces is all that its momentum knows of them too.
class LineOfSight {
 public:
  explicit LineOfSight(const CutCells& cut) : cut_(cut) {}

  /// From the present cut cells.
  void update();

  /// Between the middles of two faces of one cell.
  Sight across_cell(const Triple& cell, int d, const Triple& face, int other_d, const Triple& other_face) const;
  /// Between a face normal to d and the next one of the same kind along e, or the one before where step is -1.
  Sight to_neighbour(int d, const Triple& face, int e, int step) const;
  /// Whether that is free without a look at any wall: no more than one part in each cell on the way.
  bool is_plainly_free(int d, const Triple& face, int e, int step) const;
  bool is_one_part(const Triple& cell) const;  // all of a cell: nothing stands inside it
  /// From a piece of a face normal to d to the middle of a neighbouring face of the same kind along e.
  bool sees_neighbour(const FacePiece& piece, int d, const Triple& face, int e, int step) const;

 private:
  Sight between(int part, int other) const;
  Sight look_between(int part, int other) const;
  /// From a part of `cell` through the cell's face normal to e to a face of the next cell.
  Sight through(int from, int d, const Triple& next_face, int e, const Triple& cell, const Triple& next) const;

  const CutCells& cut_;
  std::vector<int> first_sight_;  // of each cut cell, in sights_
  std::vector<Sight> sights_;     // between each two parts of a cell: n_parts rows of n_parts
};

}  // namespace couplet::flow
