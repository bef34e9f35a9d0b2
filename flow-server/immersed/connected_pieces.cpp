#include "flow-server/immersed/connected_pieces.hpp"

#include <algorithm>
#include <numeric>

namespace couplet::flow {

namespace {

constexpr int n_edges = 12;

/// The edges of a cell: along d at the start or end of d + 1 and of d + 2.
constexpr int edge_of_cell(int d, int at_next, int at_second) {
  return 4 * d + at_next + 2 * at_second;
}

/// An edge of the face normal to d on a side of the cell, as an edge of the cell; edges of a face as in FaceCut.
constexpr int edge_of_face(int d, int side, int edge) {
  // Along d + 1: its next direction is d + 2, its second one d; along d + 2: next d, second d + 1.
  return edge < 2 ? edge_of_cell((d + 1) % 3, edge, side) : edge_of_cell((d + 2) % 3, side, edge - 2);
}

constexpr int most_segments = n_edges * FaceCut::most_segments;

/// Which of the numbers 0 .. n-1 belong together, n being at most the segments of a cell.
class Unions {
 public:
  explicit Unions(int n) { std::iota(parent_.begin(), parent_.begin() + n, 0); }
  int root(int a) {
    while (parent_[static_cast<std::size_t>(a)] != a) {
      int& parent = parent_[static_cast<std::size_t>(a)];
      parent = parent_[static_cast<std::size_t>(parent)];
      a = parent;
    }
    return a;
  }
  void join(int a, int b) {
    a = root(a), b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::array<int, most_segments> parent_;
};

}  // namespace

ConnectedPieces::ConnectedPieces(const FacesOfCell& faces) {
  // Segments of the cell's edges that face pieces join.
  std::array<int, n_edges + 1> first_segment{};
  std::array<int, n_edges> n_segments{};
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side)
      for (int edge = 0; edge < 4; ++edge)
        n_segments[static_cast<std::size_t>(edge_of_face(d, side, edge))] =
            faces[static_cast<std::size_t>(2 * d + side)].n_segments(edge);
  for (std::size_t e = 0; e < n_edges; ++e) first_segment[e + 1] = first_segment[e] + n_segments[e];
  Unions unions(first_segment[n_edges]);
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const FaceCut& face = faces[static_cast<std::size_t>(2 * d + side)];
      std::array<int, FaceCut::most_chords + 1> first_of_piece;
      first_of_piece.fill(-1);
      for (int edge = 0; edge < 4; ++edge)
        for (int s = 0; s < face.n_segments(edge); ++s) {
          const int segment = first_segment[static_cast<std::size_t>(edge_of_face(d, side, edge))] + s;
          int& first = first_of_piece[static_cast<std::size_t>(face.piece_of(edge, s))];
          if (first < 0) first = segment;
          unions.join(first, segment);
        }
    }
  std::array<int, most_segments> part_of_root;
  std::fill_n(part_of_root.begin(), first_segment[n_edges], -1);
  const auto part_of_segment = [&](int segment) {
    int& part = part_of_root[static_cast<std::size_t>(unions.root(segment))];
    if (part < 0) part = n_parts_++;
    return part;
  };
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const auto f = static_cast<std::size_t>(2 * d + side);
      for (int edge = 0; edge < 4; ++edge)
        for (int s = 0; s < faces[f].n_segments(edge); ++s)
          part_of_piece_[f][static_cast<std::size_t>(faces[f].piece_of(edge, s))] =
              part_of_segment(first_segment[static_cast<std::size_t>(edge_of_face(d, side, edge))] + s);
    }
  for (int y = 0; y < 2; ++y)  // the four edges along x hold all corners
    for (int z = 0; z < 2; ++z) {
      const auto edge = static_cast<std::size_t>(edge_of_cell(0, y, z));
      for (int x = 0; x < 2; ++x)
        part_at_corner_[static_cast<std::size_t>(x + 2 * y + 4 * z)] =
            part_of_segment(first_segment[edge] + (x == 0 ? 0 : n_segments[edge] - 1));
    }
}

}  // namespace couplet::flow
