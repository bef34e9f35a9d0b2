#pragma once
// Which pieces of the faces of a cut cell hang together.

#include <array>

#include "flow-server/immersed/face_cut.hpp"

namespace couplet::flow {

/// The faces of a cell: at the start and the end of x, then of y, then of z.
using FacesOfCell = std::array<FaceCut, 6>;

/// Pieces of faces that share an uncut stretch of an edge belong to one part of the cell.
class ConnectedPieces {
 public:
  explicit ConnectedPieces(const FacesOfCell& faces);

  int n_parts() const { return n_parts_; }
  /// Parts are counted from 0 in the order in which the faces meet them.
  int part_of(std::size_t face, int piece) const { return part_of_piece_[face][static_cast<std::size_t>(piece)]; }
  /// The part at a corner: 0 or 1 along x, y, z.
  int part_at_corner(int x, int y, int z) const { return part_at_corner_[static_cast<std::size_t>(x + 2 * y + 4 * z)]; }

 private:
  std::array<std::array<int, FaceCut::most_chords + 1>, 6> part_of_piece_{};
  std::array<int, 8> part_at_corner_{};
  int n_parts_ = 0;
};

}  // namespace couplet::flow
