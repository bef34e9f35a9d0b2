#include "flow-server/immersed/wall_forcing.hpp"

namespace couplet::flow {

namespace {

/// Layers of neighbours' cells that images reach into.
constexpr int reach = axis_margin;
/// Faces around an image may be forced themselves: so many rounds take them from each other.
constexpr int n_rounds = 2;

}  // namespace

WallForcing::WallForcing(const FlowBlock& block) : block_(block), slope_(block.new_vector_field()) {}

bool WallForcing::is_mine(int d, const Triple& face) const {
  return block_.computed_faces(d).contains(face) && block_.faces[d].contains(face[0], face[1], face[2]);
}

double WallForcing::slope_between_cells(const Field<double>& pressure, int d, const Triple& face) const {
  Triple next = face;
  ++next[d];
  return (pressure(next[0], next[1], next[2]) - pressure(face[0], face[1], face[2])) *
         block_.axis[d].inverse_control_width[face[d]];
}

double WallForcing::slope_of_face(const BodyGeometry& bodies, const Field<double>& pressure, int d,
                                  const Triple& face) const {
  const int index = bodies.cut().find_face(d, face);
  if (index < 0) {
    Triple next = face;
    ++next[d];
    return bodies.cut().is_solid(face) || bodies.cut().is_solid(next) ? 0 : slope_between_cells(pressure, d, face);
  }
  const CutFace& cut = bodies.cut().faces()[static_cast<std::size_t>(index)];
  return bodies.pieces().middle_slope(cut, pressure, bodies.piece_pressure);
}

WallForcing::Imposed WallForcing::imposed(const BodyGeometry& now, const WallValue& value,
                                          const Field<double>& pressure, const Field<double>& velocity) const {
  const WallImage& near = value.image[0];
  double slope = 0, sum = 0;
  for (std::size_t n = 0; n < 8; ++n) {
    const double weight = near.weight[n];
    if (weight == 0) continue;
    const Triple face{near.base[0] + static_cast<int>(n & 1u), near.base[1] + static_cast<int>((n >> 1) & 1u),
                      near.base[2] + static_cast<int>((n >> 2) & 1u)};
    slope +=
        weight * (now.layer().is_near(value.component, face) ? slope_[value.component](face[0], face[1], face[2])
                                                             : slope_between_cells(pressure, value.component, face));
    sum += weight;
  }
  return {WallLayer::value_of(value, velocity), sum > 0 ? slope / sum : 0};
}

/// Neighbours that a face sees, as far as they are near walls and stayed on their side.
std::vector<Triple> WallForcing::seen_beside(const BodyGeometry& now, const WallValue& value) const {
  std::vector<Triple> seen;
  const int c = value.component;
  for (int e = 0; e < block_.n_dimensions; ++e)
    for (const int step : {-1, 1}) {
      Triple next = value.face;
      next[e] += step;
      if (!now.layer().is_known(c, next) || !now.layer().is_near(c, next) || now.layer().is_inside_body(c, next) ||
          now.layer().sight().to_neighbour(c, value.face, e, step).blocked > 0)
        continue;
      seen.push_back(next);
    }
  return seen;
}

WallForcing::Imposed WallForcing::mixed(const Imposed& wall, double room, const std::vector<Triple>& beside,
                                        int component, const VectorField& velocity) const {
  if (beside.empty()) return wall;
  Imposed mean{0, 0};
  for (const Triple& face : beside) {
    mean.velocity += velocity[component](face[0], face[1], face[2]);
    mean.slope += slope_[component](face[0], face[1], face[2]);
  }
  const double n = static_cast<double>(beside.size());
  return {room * wall.velocity + (1 - room) * mean.velocity / n, room * wall.slope + (1 - room) * mean.slope / n};
}

void WallForcing::force(const BodyGeometry& before, BodyGeometry& now, double step_over_density,
                        const Field<double>& pressure, HaloExchange& halo, VectorField& velocity) {
  // Where the predictor took the slope between two cells whose places belong to different sides of a wall.
  for (const CutFace& face : before.cut().faces()) {
    const int d = face.direction;
    if (before.pieces().has_plain_slope(face) || !is_mine(d, face.face)) continue;
    velocity[d](face.face[0], face.face[1], face.face[2]) +=
        step_over_density * (slope_between_cells(pressure, d, face.face) -
                             before.pieces().middle_slope(face, pressure, before.piece_pressure));
  }
  std::vector<Field<double>*> exchanged;
  for (int d = 0; d < block_.n_dimensions; ++d) {
    for (const Triple& face : now.layer().near_faces(d))
      if (is_mine(d, face)) slope_[d](face[0], face[1], face[2]) = slope_of_face(before, pressure, d, face);
    exchanged.push_back(&velocity[d]);
    exchanged.push_back(&slope_[d]);
  }
  for (const WallValue& solid : now.layer().solid())
    velocity[solid.component](solid.face[0], solid.face[1], solid.face[2]) = solid.wall_velocity;

  const std::vector<ForcedFace>& forced = now.layer().forced();
  std::vector<double> shares;
  std::vector<std::vector<Triple>> beside;  // of faces where there is no room for an image
  now.changed_faces.clear();
  for (const ForcedFace& face : forced) {
    const int c = face.value.component, was = before.layer().find_forced(c, face.value.face);
    const ForcedFace* const old = was < 0 ? nullptr : &before.layer().forced()[static_cast<std::size_t>(was)];
    const bool has_changed = old ? old->surface == face.surface && old->is_outer != face.is_outer
                                 : before.layer().is_inside_body(c, face.value.face);
    shares.push_back(has_changed ? face.closed : face.share);
    beside.emplace_back();
    if (face.value.room < 1) beside.back() = seen_beside(now, face.value);
    if (has_changed) now.changed_faces.push_back({c, face.value.face, face.closed});
  }
  std::vector<Imposed> left(forced.size()), fresh(forced.size());  // to the equations; of a round
  for (std::size_t f = 0; f < forced.size(); ++f) {
    const auto& [i, j, k] = forced[f].value.face;
    left[f] = {velocity[forced[f].value.component](i, j, k), slope_[forced[f].value.component](i, j, k)};
  }
  for (int round = 0; round < n_rounds; ++round) {
    halo.exchange(exchanged, reach);
    for (std::size_t f = 0; f < forced.size(); ++f) {
      const double share = shares[f];
      Imposed wall = imposed(now, forced[f].value, pressure, velocity[forced[f].value.component]);
      if (!beside[f].empty()) wall = mixed(wall, forced[f].value.room, beside[f], forced[f].value.component, velocity);
      fresh[f] = {(1 - share) * left[f].velocity + share * wall.velocity,
                  (1 - share) * left[f].slope + share * wall.slope};
    }
    for (std::size_t f = 0; f < forced.size(); ++f) {
      const auto& [i, j, k] = forced[f].value.face;
      velocity[forced[f].value.component](i, j, k) = fresh[f].velocity;
      slope_[forced[f].value.component](i, j, k) = fresh[f].slope;
    }
  }
  halo.exchange(exchanged, reach);
  ghost_.clear();
  const std::vector<WallValue>& ghosts = now.layer().ghosts();
  for (std::size_t g = 0; g < ghosts.size(); ++g) {
    const WallValue& value = ghosts[g];
    ghost_.push_back(imposed(now, value, pressure, velocity[value.component]));
    if (value.room < 1)
      ghost_.back() =
          mixed(ghost_.back(), value.room, now.layer().seen_from(static_cast<int>(g)), value.component, velocity);
  }
  piece_shift_.assign(now.cut().pieces().size(), 0.0);
  for (const PieceShift& shift : now.layer().shifts()) {
    const Field<double>& u = velocity[shift.component];
    const double own = shift.ghost >= 0 ? ghost_[static_cast<std::size_t>(shift.ghost)].velocity
                                        : u(shift.face[0], shift.face[1], shift.face[2]);
    for (int n = 0; n < shift.n_neighbours; ++n) {
      const Triple& next = shift.neighbour[static_cast<std::size_t>(n)];
      piece_shift_[static_cast<std::size_t>(shift.piece)] +=
          shift.weight[static_cast<std::size_t>(n)] * (u(next[0], next[1], next[2]) - own);
    }
  }
}

void WallForcing::hold(const BodyGeometry& before, HaloExchange& halo, VectorField& velocity) const {
  std::vector<Field<double>*> exchanged;
  for (int d = 0; d < block_.n_dimensions; ++d) exchanged.push_back(&velocity[d]);
  halo.exchange(exchanged, reach);
  const std::vector<ForcedFace>& forced = before.layer().forced();
  std::vector<double> fresh;
  for (const ForcedFace& face : forced) {
    const Field<double>& u = velocity[face.value.component];
    const auto& [i, j, k] = face.value.face;
    const double share = face.share * face.value.room;
    fresh.push_back((1 - share) * u(i, j, k) + share * WallLayer::value_of(face.value, u));
  }
  for (std::size_t f = 0; f < forced.size(); ++f) {
    const auto& [i, j, k] = forced[f].value.face;
    velocity[forced[f].value.component](i, j, k) = fresh[f];
  }
  for (const WallValue& solid : before.layer().solid())
    velocity[solid.component](solid.face[0], solid.face[1], solid.face[2]) = solid.wall_velocity;
  halo.exchange(exchanged, reach);  // images of ghosts
}

void WallForcing::take_slopes_of(BodyGeometry& now, double step_over_density, const Field<double>& pressure,
                                 VectorField& velocity) {
  for (int d = 0; d < block_.n_dimensions; ++d)
    for (const Triple& face : now.layer().near_faces(d)) {
      if (!is_mine(d, face)) continue;
      velocity[d](face[0], face[1], face[2]) +=
          step_over_density * (slope_[d](face[0], face[1], face[2]) - slope_of_face(now, pressure, d, face));
    }
  const CutCells& cut = now.cut();
  piece_velocity_.assign(cut.pieces().size(), 0.0);
  for (const CutFace& face : cut.faces())
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
      const int ghost = now.layer().ghost_of_piece(p);
      if (ghost < 0) continue;
      const Imposed& value = ghost_[static_cast<std::size_t>(ghost)];
      piece_velocity_[static_cast<std::size_t>(p)] =
          value.velocity +
          step_over_density * (value.slope - now.pieces().slope(face, piece, pressure, now.piece_pressure));
    }
}

}  // namespace couplet::flow
