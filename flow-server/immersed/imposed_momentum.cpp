#include "flow-server/immersed/imposed_momentum.hpp"

#include <cmath>

namespace couplet::flow {

namespace {

/// Ghosts and hybrid velocities lie nearer to their wall than so many diagonals of their cell.
constexpr double reach_of_reaction = 2;

class ReactionOnWalls {
 public:
  ReactionOnWalls(const FlowBlock& block, const FlowState& state, std::vector<SurfaceLoad>& loads)
      : block_(block), state_(state), bodies_(*state.bodies), loads_(loads), hint_(loads.size(), -1) {}

  void add_hybrid(const ForcedFace& forced, double density) {
    const int d = forced.value.component;
    const auto& [i, j, k] = forced.value.face;
    const double slip = bodies_.layer().imposed(forced.value, state_.velocity[d]) - state_.velocity[d](i, j, k);
    const double volume = share_of_middle(d, forced.value.face) * volume_of(d, forced.value.face);
    add(forced.surface, d, forced.value.face, -density * volume * forced.share * slip / state_.last_step);
  }

  void add_piece(const CutFace& face, const FacePiece& piece, const WallValue& ghost) {
    const int d = face.direction;
    const double difference =
        bodies_.pieces().slope(face, piece, state_.pressure, bodies_.piece_pressure) - slope_imposed(ghost);
    add(piece.surface, d, face.face, -(1 - piece.opening) * piece.share * volume_of(d, face.face) * difference);
  }

 private:
  /// Of a face: its area times the distance between the middles of its cells.
  double volume_of(int d, const Triple& face) const {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    return block_.axis[e].width[face[e]] * block_.axis[f].width[face[f]] /
           block_.axis[d].inverse_control_width[face[d]];
  }

  /// Share of the face's area that has the velocity of its middle.
  double share_of_middle(int d, const Triple& at) const {
    const CutCells& cut = bodies_.cut();
    const int index = cut.find_face(d, at);
    if (index < 0) return 1;
    const CutFace& face = cut.faces()[static_cast<std::size_t>(index)];
    double share = 0;
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
      if (p == face.centre_piece)
        share += piece.share;
      else if (bodies_.layer().ghost_of_piece(p) >= 0)
        share += piece.opening * piece.share;
    }
    return share;
  }

  /// What WallLayer::imposed() is to velocities, of the slopes of the pressure; of the nearer image alone.
  double slope_imposed(const WallValue& value) const {
    const WallImage& near = value.image[0];
    double slope = 0;
    for (unsigned n = 0; n < near.weight.size(); ++n)
      if (near.weight[n] != 0)
        slope += near.weight[n] *
                 slope_at(value.component, {near.base[0] + (n & 1u ? 1 : 0), near.base[1] + (n & 2u ? 1 : 0),
                                            near.base[2] + (n & 4u ? 1 : 0)});
    const double seen = near.seen();
    if (seen > 0) slope /= seen;
    if (value.room >= 1) return slope;
    double beside = 0;
    for (const Triple& face : bodies_.layer().beside(value)) beside += slope_at(value.component, face);
    return value.room * slope + (1 - value.room) * beside / value.n_beside;
  }

  double slope_at(int d, const Triple& face) const {
    return bodies_.pieces().slope_at(d, face, state_.pressure, bodies_.piece_pressure);
  }

  /// A force along d at the wall's point nearest to the middle of a face, on corners by the weights with which they
  /// move that point.
  void add(int surface, int d, const Triple& face, double force) {
    const auto s = static_cast<std::size_t>(surface);
    Point at{};
    double square = 0;
    for (int e = 0; e < 3; ++e) {
      const AxisValues& places = e == d ? block_.axis[e].face : block_.axis[e].centre;
      at[static_cast<std::size_t>(e)] = places[face[e]];
      square += std::pow(block_.axis[e].width[face[e]], 2);
    }
    const ClosestPoint wall = bodies_.trees()[s].closest(at, reach_of_reaction * std::sqrt(square), hint_[s]);
    if (!wall.is_found()) return;
    hint_[s] = wall.hint;
    const auto& corners = bodies_.surfaces()[s].triangle[static_cast<std::size_t>(wall.triangle)];
    for (std::size_t v = 0; v < 3; ++v)
      loads_[s].corner_force[static_cast<std::size_t>(corners[v])][static_cast<std::size_t>(d)] +=
          wall.weight[v] * force;
    loads_[s].pressure_force[static_cast<std::size_t>(d)] += force;
  }

  const FlowBlock& block_;
  const FlowState& state_;
  const BodyGeometry& bodies_;
  std::vector<SurfaceLoad>& loads_;
  std::vector<int> hint_;  // of each surface's tree: from the query before
};

}  // namespace

void add_imposed_momentum(const FlowBlock& block, double density, const FlowState& state,
                          std::vector<SurfaceLoad>& loads) {
  if (!(state.last_step > 0)) return;  // nothing was imposed yet
  const BodyGeometry& bodies = *state.bodies;
  ReactionOnWalls reaction(block, state, loads);
  for (const ForcedFace& forced : bodies.layer().forced()) reaction.add_hybrid(forced, density);
  const Box mine = box_of(block.sizes);
  for (const CutFace& face : bodies.cut().faces()) {
    if (!mine.contains(face.face)) continue;
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const int ghost = bodies.layer().ghost_of_piece(p);
      if (ghost < 0) continue;
      reaction.add_piece(face, bodies.cut().pieces()[static_cast<std::size_t>(p)],
                         bodies.layer().ghosts()[static_cast<std::size_t>(ghost)]);
    }
  }
}

}  // namespace couplet::flow
