#pragma once
// The pressure problem in cut cells: open shares of faces, and unknowns beyond one a cell.

#include <span>
#include <vector>

#include "flow-server/immersed/cut_cells.hpp"
#include "flow-server/momentum/flow_block.hpp"
#include "flow-server/poisson/pressure_solver.hpp"

namespace couplet::flow {

/// The unknowns of the pressure at one position of the bodies. Values of further pieces are in the order of
/// CutCells::further_parts().
class PressurePieces {
 public:
  PressurePieces(const FlowBlock& block, const CutCells& cut) : block_(block), cut_(cut) {}

  /// From the present cut cells, which were made of these surfaces.
  void update(std::span<const BodySurface> surfaces);

  /// Share of the face that joins the fields' places of the cells on both sides; of all faces beside cut cells of this
  /// rank and one layer around it.
  struct FaceShare {
    int direction;
    Triple face;
    float share;
  };
  const std::vector<FaceShare>& shares() const { return shares_; }
  const SplitCells& split() const { return split_; }
  /// (n_pieces of split) the further part of each of its pieces: index in CutCells::further_parts().
  const std::vector<int>& listed() const { return listed_; }

  /// Of the part of a cell, or of the cell where that is whole (part -1).
  double value_at(int part, const Triple& cell, const Field<double>& cells, std::span<const double> pieces) const;
  /// Slope of a pressure across a piece of a face [Pa/m]; 0 where one side is solid.
  double slope(const CutFace& face, const FacePiece& piece, const Field<double>& cells,
               std::span<const double> pieces) const;
  /// Slope that acts on the velocity at the middle of a face, an index in CutCells::faces(): that across its piece;
  /// where a smooth free edge opens another piece to it, the mean of both by the area for which that velocity stands.
  double middle_slope(int face, const Field<double>& cells, std::span<const double> pieces) const;
  /// That is what a sweep over the fields finds: both sides of the piece are the cells' places, and no other is open.
  bool has_plain_slope(const CutFace& face) const;
  /// Indices of all cut faces for which it is not so.
  const std::vector<int>& faces_of_own_slope() const { return faces_of_own_slope_; }
  bool is_fluid(int part, const Triple& cell) const;

 private:
  bool joins_cells(const CutFace& face, const FacePiece& piece) const;
  PressureUnknown unknown_of(int part, const Triple& cell) const;
  bool is_given(const Triple& cell) const;  // to the solver: of this rank and one layer around it
  void add_face(const CutFace& face);
  void add_middle_slope(const CutFace& face);
  void add_free_edges(const CutCell& cut, std::span<const BodySurface> surfaces);

  const FlowBlock& block_;
  const CutCells& cut_;
  std::vector<FaceShare> shares_;
  SplitCells split_;
  std::vector<int> listed_, faces_of_own_slope_;
  /// weight * (upper - lower); `piece` is here the number of a further part.
  struct SlopeTerm {
    PressureUnknown lower, upper;
    double weight;  // [1/m]
  };
  std::vector<SlopeTerm> slope_terms_;  // of the middles of all cut faces, in their order
  std::vector<int> first_slope_term_;   // (n_faces + 1)
  std::vector<int> place_in_list_;      // (n_further_parts) in split_; -1: not given
};

}  // namespace couplet::flow
