#include "flow-server/immersed/wall_forcing.hpp"

#include <algorithm>

namespace couplet::flow {

namespace {

/// Faces around an image may be forced themselves: so many rounds take them from each other.
constexpr int n_forcing_rounds = 2;

}  // namespace

WallForcing::WallForcing(const FlowBlock& block) : block_(block), slope_(block.new_vector_field()) {}

bool WallForcing::is_mine(int d, const Triple& face) const {
  return block_.computed_faces(d).contains(face) && block_.faces[d].contains(face[0], face[1], face[2]);
}

double WallForcing::slope_of_face(const BodyGeometry& bodies, const Field<double>& pressure, int d,
                                  const Triple& face) const {
  return bodies.layer().is_of_whole_cells(d, face) ? bodies.pieces().slope_between_cells(d, face, pressure)
                                                   : bodies.pieces().slope_at(d, face, pressure, bodies.piece_pressure);
}

WallForcing::Imposed WallForcing::imposed(const WallLayer& layer, const WallValue& value,
                                          const Field<double>& velocity) const {
  const WallImage& near = value.image[0];
  const Field<double>& slopes = slope_[value.component];
  const double* const g = slopes.row(near.base[1], near.base[2]) + near.base[0];
  double slope = 0, sum = 0;
  for (unsigned n = 0; n < 8; ++n) {
    const double weight = near.weight[n];
    if (weight == 0) continue;
    slope += weight * g[(n & 1u ? 1 : 0) + (n & 2u ? slopes.stride_y() : 0) + (n & 4u ? slopes.stride_z() : 0)];
    sum += weight;
  }
  if (sum > 0) slope /= sum;
  if (value.room < 1) slope = value.room * slope + (1 - value.room) * layer.mean_beside(value, slopes);
  return {layer.imposed(value, velocity), slope};
}

void WallForcing::take_slopes_of_images(const BodyGeometry& now, const Field<double>& pressure) {
  for (int d = 0; d < block_.n_dimensions; ++d)
    for (const Triple& face : now.layer().image_faces(d)) {
      // The pressure behind the last layer is not known: the slope before it stands in. Only images of ghosts that
      // other ranks own reach there.
      Triple from = face;
      from[d] = std::min(from[d], block_.sizes[d] + block_.ghosts[d] - 2);
      slope_[d](face[0], face[1], face[2]) = now.pieces().slope_between_cells(d, from, pressure);
    }
}

void WallForcing::mend_slopes(const BodyGeometry& before, double step_over_density, const Field<double>& pressure,
                              VectorField& velocity) const {
  for (const int index : before.pieces().faces_of_own_slope()) {
    const CutFace& face = before.cut().faces()[static_cast<std::size_t>(index)];
    const int d = face.direction;
    if (!is_mine(d, face.face)) continue;
    velocity[d](face.face[0], face.face[1], face.face[2]) +=
        step_over_density * (before.pieces().slope_between_cells(d, face.face, pressure) -
                             before.pieces().middle_slope(index, pressure, before.piece_pressure));
  }
}

void WallForcing::force(const BodyGeometry& before, BodyGeometry& now, const Field<double>& pressure,
                        const FillGhosts& fill_ghosts, VectorField& velocity) {
  // On borders there is no slope but on openings; what another rank computes is exchanged, what lies beyond borders
  // filled.
  for (int d = 0; d < block_.n_dimensions; ++d)
    for (const Triple& face : now.layer().near_faces(d))
      slope_[d](face[0], face[1], face[2]) = is_mine(d, face) ? slope_of_face(before, pressure, d, face) : 0;
  take_slopes_of_images(now, pressure);
  for (const WallValue& solid : now.layer().solid())
    velocity[solid.component](solid.face[0], solid.face[1], solid.face[2]) = solid.wall_velocity;

  const std::vector<ForcedFace>& forced = now.layer().forced();
  share_.clear();
  now.changed_faces.clear();
  for (const ForcedFace& face : forced) {
    const int c = face.value.component, was = before.layer().find_forced(c, face.value.face);
    const ForcedFace* const old = was < 0 ? nullptr : &before.layer().forced()[static_cast<std::size_t>(was)];
    const bool has_changed = old ? old->surface == face.surface && old->is_outer != face.is_outer
                                 : before.layer().is_inside_body(c, face.value.face);
    share_.push_back(has_changed ? face.closed : face.share);
    if (has_changed) now.changed_faces.push_back({c, face.value.face, face.closed});
  }
  left_.resize(forced.size()), fresh_.resize(forced.size());
  for (std::size_t f = 0; f < forced.size(); ++f) {
    const auto& [i, j, k] = forced[f].value.face;
    left_[f] = {velocity[forced[f].value.component](i, j, k), slope_[forced[f].value.component](i, j, k)};
  }
  for (int round = 0; round < n_forcing_rounds; ++round) {
    fill_ghosts(velocity, &slope_);
    take_slopes_of_images(now, pressure);  // in ghosts too, which the exchange has overwritten
    for (std::size_t f = 0; f < forced.size(); ++f) {
      const double share = share_[f];
      const Imposed wall = imposed(now.layer(), forced[f].value, velocity[forced[f].value.component]);
      fresh_[f] = {(1 - share) * left_[f].velocity + share * wall.velocity,
                   (1 - share) * left_[f].slope + share * wall.slope};
    }
    for (std::size_t f = 0; f < forced.size(); ++f) {
      const auto& [i, j, k] = forced[f].value.face;
      velocity[forced[f].value.component](i, j, k) = fresh_[f].velocity;
      slope_[forced[f].value.component](i, j, k) = fresh_[f].slope;
    }
  }
  fill_ghosts(velocity, &slope_);
  take_slopes_of_images(now, pressure);
  ghost_.clear();
  for (const WallValue& value : now.layer().ghosts())
    ghost_.push_back(imposed(now.layer(), value, velocity[value.component]));
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

void WallForcing::hold(const BodyGeometry& before, const BodyGeometry& now, double elapsed,
                       const FillGhosts& fill_ghosts, VectorField& velocity) {
  fill_ghosts(velocity, nullptr);
  // Of both places; a face that the wall passes over belongs to the one where it is in the fluid.
  held_.clear();
  for (const bool is_end : {false, true}) {
    const WallLayer& here = (is_end ? now : before).layer();
    const WallLayer& there = (is_end ? before : now).layer();
    for (const ForcedFace& face : here.forced()) {
      const auto& [i, j, k] = face.value.face;
      const Field<double>& u = velocity[face.value.component];
      const bool is_passed = there.is_inside_body(face.value.component, face.value.face);
      const double weight = is_passed ? 1 : is_end ? elapsed : 1 - elapsed;
      const double share = is_passed && is_end ? face.closed : face.share;
      held_.push_back(
          {face.value.component, face.value.face, weight * share * (here.imposed(face.value, u) - u(i, j, k))});
    }
  }
  for (const auto& [c, face, change] : held_) velocity[c](face[0], face[1], face[2]) += change;
  for (const WallValue& solid : before.layer().solid())
    if (now.layer().find_forced(solid.component, solid.face) < 0)
      velocity[solid.component](solid.face[0], solid.face[1], solid.face[2]) = solid.wall_velocity;
  fill_ghosts(velocity, nullptr);  // for images of ghosts
}

void WallForcing::release(VectorField& velocity) const {
  for (const auto& [c, face, change] : held_) velocity[c](face[0], face[1], face[2]) -= change;
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
  find_opening_flow(now, step_over_density, pressure);
}

void WallForcing::find_opening_flow(const BodyGeometry& now, double step_over_density, const Field<double>& pressure) {
  const CutCells& cut = now.cut();
  opening_flow_.assign(cut.walls().size(), 0.0);
  const Box mine = box_of(block_.sizes);
  for (const CutCell& cell : cut.cells()) {
    if (!mine.contains(cell.cell)) continue;
    for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
      const WallTriangle& wall = cut.walls()[static_cast<std::size_t>(w)];
      const double conductance = now.pieces().conductance(wall, cell.cell, now.surfaces());
      if (conductance == 0) continue;
      double flow = 0;
      for (int d = 0; d < block_.n_dimensions; ++d)
        for (const int back : {0, 1}) {
          Triple face = cell.cell;
          face[d] -= back;
          if (!block_.faces[d].contains(face[0], face[1], face[2])) continue;  // its velocity is given
          flow += wall.opening * wall.area[d] * 0.5 * slope_of_face(now, pressure, d, face);
        }
      const auto side = [&](int part) { return now.pieces().value_at(part, cell.cell, pressure, now.piece_pressure); };
      opening_flow_[static_cast<std::size_t>(w)] =
          step_over_density * (flow - conductance * (side(wall.outer_part) - side(wall.inner_part)));
    }
  }
}

}  // namespace couplet::flow
