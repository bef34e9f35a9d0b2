// How the mean velocities of pieces of faces differ from that in the faces' middles.

#include <algorithm>
#include <cmath>

#include "flow-server/immersed/wall_layer.hpp"

namespace couplet::flow {

void WallLayer::add_pieces() {
  ghost_of_piece_.assign(cut_.pieces().size(), -1);
  shifts_.clear();
  for (const CutFace& face : cut_.faces()) {
    // Faces of own cells; on a border with a given velocity all pieces have that.
    Box wanted = box_of(block_.sizes);
    --wanted.begin[face.direction];
    if (face.n_pieces == 1 || !wanted.contains(face.face) ||
        !block_.faces[face.direction].contains(face.face[0], face.face[1], face.face[2]))
      continue;
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
      const int part = piece.lower_part >= 0 ? piece.lower_part : piece.upper_part;
      if (!cut_.parts()[static_cast<std::size_t>(part)].is_fluid) continue;
      if (p != face.centre_piece && piece.surface >= 0)
        ghost_of_piece_[static_cast<std::size_t>(p)] = ghost(face.direction, face.face, piece.surface, piece.is_outer);
      add_shift(face, p);
    }
  }
}

void WallLayer::add_shift(const CutFace& face, int p) {
  const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
  const int d = face.direction;
  // Pieces that nothing parts are one, with its middle where that of the face is. The chord of the piece with that
  // middle is the one that parts it best.
  double closed = p == face.centre_piece ? 0 : 1 - piece.opening;
  if (p == face.centre_piece)
    for (int q = face.first_piece; q < face.first_piece + face.n_pieces; ++q)
      if (q != p) closed = std::max(closed, 1 - cut_.pieces()[static_cast<std::size_t>(q)].opening);
  PieceShift shift{.piece = p,
                   .component = d,
                   .face = face.face,
                   .ghost = ghost_of_piece_[static_cast<std::size_t>(p)],
                   .n_neighbours = 0,
                   .neighbour = {}};
  const auto add = [&](const Triple& next, double weight) {
    const auto n = static_cast<std::size_t>(shift.n_neighbours++);
    shift.neighbour[n] = next, shift.weight[n] = weight;
  };
  const auto step_along = [&](Triple from, int e, int step) {
    from[e] += step;
    return from;
  };
  /// Distance of the piece's middle along e over that of two faces.
  const auto ratio = [&](int t, const Triple& a, const Triple& b) {
    const int e = (d + 1 + t) % 3;
    return closed * std::abs(piece.offset[static_cast<std::size_t>(t)]) *
           block_.axis[e].inverse_distance[std::min(a[e], b[e])];
  };
  const auto direction_to = [&](int t) { return piece.offset[static_cast<std::size_t>(t)] > 0 ? 1 : -1; };
  std::array<bool, 2> is_wanted{}, is_seen{};
  for (int t = 0; t < 2; ++t) {
    const int e = (d + 1 + t) % 3;
    if (e >= block_.n_dimensions || piece.offset[static_cast<std::size_t>(t)] == 0) continue;
    is_wanted[static_cast<std::size_t>(t)] = true;
    const Triple next = step_along(face.face, e, direction_to(t));
    if (!is_known(d, next) || !sight_.sees_neighbour(piece, d, face.face, e, direction_to(t))) continue;
    is_seen[static_cast<std::size_t>(t)] = true;
    add(next, ratio(t, face.face, next));
  }
  // Behind an oblique wall one of both neighbours is: there the slope along it is that beside the other one.
  for (int t = 0; t < 2; ++t) {
    if (!is_wanted[static_cast<std::size_t>(t)] || is_seen[static_cast<std::size_t>(t)] ||
        !is_seen[static_cast<std::size_t>(1 - t)])
      continue;
    const Triple next = shift.neighbour[0];
    const int e = (d + 1 + t) % 3;
    for (const int sign : {1, -1}) {
      const int step = sign * direction_to(t);
      const Triple corner = step_along(next, e, step);
      if (!is_known(d, corner) || sight_to(d, next, e, step).blocked > 0) continue;
      const double weight = sign * ratio(t, next, corner);
      shift.weight[0] -= weight;
      add(corner, weight);
      break;
    }
  }
  if (shift.n_neighbours > 0) shifts_.push_back(shift);
}

}  // namespace couplet::flow
