#pragma once
// The cells that surfaces cut: their connected parts, the pieces of their faces, and the wall inside them.

#include <vector>

#include "flow-server/immersed/connected_pieces.hpp"

namespace couplet::flow {

/// A connected part of a cut cell: what is left of the cell's rim when the traces of the surfaces are taken out of it.
struct CellPart {
  int cell = 0;            // index in CutCells::cells()
  bool is_fluid = true;    // not inside a closed body
  double open_area = 0;    // of its pieces of the cell's faces [m^2]
  int further_piece = -1;  // -1: its pressure stands in the cell's place of the fields; else number in the list
};

/// A cell with a crossing on one of its twelve edges.
struct CutCell {
  Triple cell;
  int first_part = 0, n_parts = 0;
  int first_wall = 0, n_walls = 0;
  int main_part = -1;                                // whose pressure stands in the fields; -1: no fluid in this cell
  std::array<std::array<int, 2>, 3> part_at_face{};  // where the middles of its faces stand: direction, start or end
};

/// The middle of the wall of one surface between two parts of a cell: the mean of its corners, or of the bends among
/// them if there are any.
struct WallMiddle {
  int first_point = 0, n_points = 0;  // in CutCells::middle_points()
};
/// A point of a surface, and how much of its place and velocity a point of the wall has.
struct WeighedPoint {
  const SurfacePoint* point = nullptr;
  double weight = 0;
};

/// A triangle of the wall inside a cell: between a chord on one of the cell's faces and the middle of the wall there.
/// The sum over a closed chain of chords is the wall's area whatever the middle is, and closes the parts on both sides:
/// their face pieces and their wall sum to no area. Where the walls of two surfaces cross in a cell, each is parted
/// along the line between the crossings of their chords, to which further triangles lead.
struct WallTriangle {
  int surface = 0;
  int outer_part = 0, inner_part = 0;  // indices in CutCells::parts(); may be equal where the wall ends in the cell
  Eigen::Vector3d area;                // towards the outer side [m^2]
  std::array<WeighedPoint, 4> end{};   // of the chord, or those between which its ends lie; they sum to 2/3
  int middle = 0;                      // index in CutCells::middles()
  Eigen::Vector3d centroid;            // [m]
  Eigen::Vector3d velocity;            // mean over the triangle [m/s]
  double opening = 0;
};

/// A piece of a cut face.
struct FacePiece {
  double share = 0;                      // of the face's area
  std::array<double, 2> offset{};        // of its middle from that of the face, along d + 1 and d + 2 [m]
  int lower_part = -1, upper_part = -1;  // parts of the cells on both sides; -1: a whole cell, or none looked at
  /// The chord that bounds it towards the piece with the face's middle; of no meaning for that piece itself.
  int surface = -1;
  bool is_outer = false;  // lies on the outer side of that chord
  double opening = 0;     // of the surface there
};

/// A face of a cut cell, be it cut itself or whole.
struct CutFace {
  int direction = 0;
  Triple face;  // as entries of velocity fields: between the cell of these indices and the next one in the direction
  int first_piece = 0, n_pieces = 0;
  int centre_piece = 0;  // index in CutCells::pieces() of the one with the face's middle
};

/// All of the cells looked at that surfaces cut; everything depends on the surfaces and the grid alone, so that ranks
/// that look at the same cell have the same numbers.
class CutCells {
 public:
  CutCells(const StretchedGrid& grid, const EdgeCrossings& crossings);

  /// From the present crossings.
  void update(std::span<const BodySurface> surfaces);

  const EdgeCrossings& crossings() const { return crossings_; }
  const std::vector<CutCell>& cells() const { return cells_; }  // in rising order of k, j, i
  const std::vector<CellPart>& parts() const { return parts_; }
  const std::vector<CutFace>& faces() const { return faces_; }
  const std::vector<FacePiece>& pieces() const { return pieces_; }
  const std::vector<WallTriangle>& walls() const { return walls_; }
  const std::vector<WallMiddle>& middles() const { return middles_; }
  const std::vector<WeighedPoint>& middle_points() const { return middle_points_; }
  const std::vector<int>& further_parts() const { return further_parts_; }  // of each further piece

  /// Index of a cut cell, -1 where nothing cuts it.
  int find(const Triple& cell) const;
  /// Index of a face of a cut cell, -1 where both cells are whole.
  int find_face(int d, const Triple& face) const;
  /// Those of the given cells that no surface cuts and that are not inside a closed body.
  ActiveCells whole(const ActiveCells& cells) const;
  /// Whether a cell, or the middle of a face, is inside a closed body.
  bool is_solid(const Triple& cell) const;
  bool is_face_solid(int d, const Triple& face) const;
  /// The part of a cell at which the middle of one of its faces stands: index in parts(), or -1 in a cell that is
  /// whole.
  int part_at(const Triple& cell, int d, const Triple& face) const;
  /// How much of the surface between two parts of a cell is open: 0 where they are parted, 1 where they are one.
  double opening_between(int part, int other) const;

  /// Volume of the fluid in a cut cell [m^3].
  double fluid_volume(const CutCell& cell) const;

  int n_lone_crossings() const { return n_lone_crossings_; }  // faces in which a surface ends

 private:
  void add_cell(const Triple& cell, std::span<const BodySurface> surfaces);
  void add_walls(CutCell& cut, const FacesOfCell& faces, const ConnectedPieces& connected);

  const StretchedGrid& grid_;
  const EdgeCrossings& crossings_;
  std::vector<CutCell> cells_;
  std::vector<CellPart> parts_;
  std::vector<CutFace> faces_;
  std::vector<FacePiece> pieces_;
  std::vector<WallTriangle> walls_;
  std::vector<WallMiddle> middles_;
  std::vector<WeighedPoint> middle_points_;
  std::vector<int> further_parts_;
  /// Of a cell and the faces at its end, side by side in memory; counted from 1.
  struct Place {
    int cell = 0;               // in cells_
    std::array<int, 3> face{};  // in faces_
  };
  Place& place(const Triple& at) { return place_(at[0], at[1], at[2]); }
  const Place& place(const Triple& at) const { return place_(at[0], at[1], at[2]); }
  Field<Place> place_;
  int n_lone_crossings_ = 0;
};

}  // namespace couplet::flow
