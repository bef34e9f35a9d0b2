#pragma once
// How surfaces cut one face of a cell into pieces.

#include <array>
#include <cstdint>
#include <span>

#include "flow-server/immersed/edge_crossings.hpp"

namespace couplet::flow {

/// A straight part of a surface's trace on a face: the trace runs from one crossing of its rim to another, bends where
/// a sharp edge of a body passes through the face, and is parted where the trace of another surface crosses it, as
/// where one body stands in another.
struct Chord {
  /// Crossings of the rim, or bends, between which it lies. From the start of the trace on, counterclockwise around the
  /// positive normal, is the outer side.
  const SurfacePoint *from = nullptr, *to = nullptr;
  double from_share = 0, to_share = 1;         // where it begins and ends on the way from one to the other
  Eigen::Vector3d from_position, to_position;  // of its own ends [m]
  std::array<bool, 2> has_bend{};              // whether it begins, and ends, in a bend
  int outer_piece = 0, inner_piece = 0;
  int surface() const { return from->surface; }
  bool is_crossed() const { return from_share > 0 || to_share < 1; }  // at one end, by another trace
  double opening() const { return 0.5 * (from->opening + to->opening); }
};

/// The face normal to direction d whose corner with the smallest coordinates is given. Its rim is followed
/// counterclockwise; crossings of one surface are joined by traces that do not cross each other, through the bends of
/// that surface in the face, and two points of the face are on one piece where no trace lies between them. Traces of
/// two surfaces may cross once. A crossing without a partner (the surface ends inside the face) parts nothing.
class FaceCut {
 public:
  static constexpr int most_traces = 6;
  static constexpr int most_chords = 24;
  static constexpr int most_segments = 8;  // of an edge, between its crossings

  FaceCut(const EdgeCrossings& crossings, int d, const Triple& corner);

  int n_pieces() const { return n_pieces_; }
  double share(int piece) const { return share_[static_cast<std::size_t>(piece)]; }  // of the face's area
  /// Middle of a piece, in the face from 0 to 1 along d + 1 and d + 2.
  const Eigen::Vector2d& centroid(int piece) const { return centroid_[static_cast<std::size_t>(piece)]; }
  int centre_piece() const { return centre_piece_; }
  int n_chords() const { return n_chords_; }
  const Chord& chord(int c) const { return chords_[static_cast<std::size_t>(c)]; }
  /// The piece that holds the part of an edge before its first, second, ... crossing. Edges: 0 and 1 along d + 1 at the
  /// start and the end of d + 2, 2 and 3 along d + 2 at the start and the end of d + 1.
  int piece_of(int edge, int segment) const {
    return piece_of_segment_[static_cast<std::size_t>(edge)][static_cast<std::size_t>(segment)];
  }
  int n_segments(int edge) const { return n_segments_[static_cast<std::size_t>(edge)]; }
  bool has_lone_crossing() const { return has_lone_crossing_; }

 private:
  struct RimCrossing;
  struct Trace;
  void add_chords(std::span<const Trace> traces, int t, int outer_piece, int inner_piece, const auto& position_of,
                  const auto& piece_beside);
  int n_pieces_ = 1, n_chords_ = 0, centre_piece_ = 0;
  bool has_lone_crossing_ = false;
  std::array<double, most_traces + 1> share_{};
  std::array<Eigen::Vector2d, most_traces + 1> centroid_;
  std::array<Chord, most_chords> chords_;
  std::array<int, 4> n_segments_{};
  std::array<std::array<std::uint8_t, most_segments>, 4> piece_of_segment_{};
};

}  // namespace couplet::flow
