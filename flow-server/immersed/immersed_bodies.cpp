#include "flow-server/immersed/immersed_bodies.hpp"

#include <mpi.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace couplet::flow {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
/// Cells around cut ones whose pressure slopes are asked for.
constexpr int n_layers_of_guess = 2;
/// Rounds in which new parts take the pressure of their neighbours.
constexpr int n_rounds = 3;

bool has_periodic_direction(const FlowBlock& block) {
  const std::array<bool, 3>& is_periodic = block.decomposition->is_periodic();
  return is_periodic[0] || is_periodic[1] || is_periodic[2];
}

}  // namespace

ImmersedBodies::ImmersedBodies(const FlowBlock& block, const BodyFlowSettings& settings)
    : block_(block), settings_(settings), forcing_(block) {}

std::shared_ptr<BodyGeometry> ImmersedBodies::make_geometry(std::vector<BodySurface> surfaces) const {
  auto geometry = std::make_shared<BodyGeometry>(block_, settings_);
  geometry->place(std::move(surfaces));
  return geometry;
}

/// With those at the start of the block, whoever owns them: a sweep over the fields corrects them too.
bool ImmersedBodies::is_of_my_cells(int d, const Triple& face) const {
  Box faces = box_of(block_.sizes);
  faces.begin[d] = -1;
  return faces.contains(face) && block_.faces[d].contains(face[0], face[1], face[2]);
}

bool ImmersedBodies::write_problem(const BodyGeometry& now, PressureProblem& problem, std::vector<Box>& changed) {
  FaceFractions& share = *problem.open_share;
  const auto set = [&](int d, const Triple& face, float value) {
    float& place = share[d](face[0], face[1], face[2]);
    if (place == value) return;
    place = value;
    Triple end = face;
    for (int e = 0; e < 3; ++e) end[e] += e == d ? 2 : 1;
    changed.push_back({face, end});
  };
  const auto whole = [&](int d, const Triple& face) {
    Triple next = face;
    ++next[d];
    const Box& known = block_.faces[d].range();
    const bool is_open = !known.contains(face) || block_.faces[d].contains(face[0], face[1], face[2]);
    return is_open && !now.cut().is_solid(face) && !now.cut().is_solid(next) ? 1.0f : 0.0f;
  };
  if (!follows_last_) {
    for (int d = 0; d < block_.n_dimensions; ++d) {
      Box faces = box_of(block_.sizes);
      faces.begin[d] = -1;
      for (int k = faces.begin[2]; k < faces.end[2]; ++k)
        for (int j = faces.begin[1]; j < faces.end[1]; ++j)
          for (int i = faces.begin[0]; i < faces.end[0]; ++i)
            if (block_.faces[d].contains(i, j, k)) set(d, {i, j, k}, whole(d, {i, j, k}));
    }
    follows_last_ = true;
  }
  for (const PressurePieces::FaceShare& old : written_)
    if (now.cut().find_face(old.direction, old.face) < 0) set(old.direction, old.face, whole(old.direction, old.face));
  for (const PressurePieces::FaceShare& fresh : now.pieces().shares()) set(fresh.direction, fresh.face, fresh.share);
  written_ = now.pieces().shares();
  int has_changed = !changed.empty() || problem.split != now.pieces().split() ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &has_changed, 1, MPI_INT, MPI_MAX, block_.decomposition->communicator());
  if (has_changed == 1) problem.split = now.pieces().split();
  return has_changed == 1;
}

void ImmersedBodies::carry_pressure(const BodyGeometry& before, const Field<double>& pressure, BodyGeometry& now,
                                    Field<double>& guess) const {
  const CutCells& cut = now.cut();
  const CutCells& old = before.cut();
  Box known = box_of(block_.sizes);
  for (int d = 0; d < block_.n_dimensions; ++d) known.begin[d] -= block_.ghosts[d], known.end[d] += block_.ghosts[d];
  const int depth = block_.n_dimensions == 3 ? n_layers_of_guess : 0;
  for (const CutCell& cell : cut.cells())
    for (int k = cell.cell[2] - depth; k <= cell.cell[2] + depth; ++k)
      for (int j = cell.cell[1] - n_layers_of_guess; j <= cell.cell[1] + n_layers_of_guess; ++j)
        for (int i = cell.cell[0] - n_layers_of_guess; i <= cell.cell[0] + n_layers_of_guess; ++i)
          if (known.contains({i, j, k})) guess(i, j, k) = pressure(i, j, k);

  // A part that was there before, on the same side of a surface, keeps its pressure; so does the larger part of a cell
  // that has just been cut.
  std::vector<double> value(cut.parts().size(), unknown);
  const auto has_side = [](const CutCells& cells, const CutCell& cell, int part, int surface, bool is_outer) {
    for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
      const WallTriangle& wall = cells.walls()[static_cast<std::size_t>(w)];
      if (wall.surface == surface && wall.outer_part != wall.inner_part &&
          (is_outer ? wall.outer_part : wall.inner_part) == part)
        return true;
    }
    return false;
  };
  for (const CutCell& cell : cut.cells()) {
    const int index = old.find(cell.cell);
    if (index < 0) {
      if (cell.main_part >= 0 && known.contains(cell.cell) && !old.is_solid(cell.cell))
        value[static_cast<std::size_t>(cell.main_part)] = pressure(cell.cell[0], cell.cell[1], cell.cell[2]);
      continue;
    }
    const CutCell& was = old.cells()[static_cast<std::size_t>(index)];
    for (int part = cell.first_part; part < cell.first_part + cell.n_parts; ++part)
      for (int p = was.first_part; p < was.first_part + was.n_parts; ++p) {
        if (!old.parts()[static_cast<std::size_t>(p)].is_fluid || !std::isnan(value[static_cast<std::size_t>(part)]))
          continue;
        bool is_same = was.n_parts == 1 && cell.n_parts == 1;
        for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls && !is_same; ++w) {
          const WallTriangle& wall = cut.walls()[static_cast<std::size_t>(w)];
          if (wall.outer_part == wall.inner_part || (wall.outer_part != part && wall.inner_part != part)) continue;
          is_same = has_side(old, was, p, wall.surface, wall.outer_part == part);
        }
        if (is_same && (p == was.main_part || old.parts()[static_cast<std::size_t>(p)].further_piece >= 0) &&
            known.contains(cell.cell))
          value[static_cast<std::size_t>(part)] =
              before.pieces().value_at(p, cell.cell, pressure, before.piece_pressure);
      }
  }
  // New ones take the mean of what they are joined to.
  std::vector<double> sum(value.size()), weight(value.size());
  const auto is_unknown = [](double carried) { return std::isnan(carried); };
  for (int round = 0; round < n_rounds && std::any_of(value.begin(), value.end(), is_unknown); ++round) {
    std::fill(sum.begin(), sum.end(), 0.0);
    std::fill(weight.begin(), weight.end(), 0.0);
    for (const CutFace& face : cut.faces()) {
      Triple next = face.face;
      ++next[face.direction];
      for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
        const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
        for (const bool to_lower : {true, false}) {
          const int part = to_lower ? piece.lower_part : piece.upper_part;
          const int other = to_lower ? piece.upper_part : piece.lower_part;
          const Triple& cell = to_lower ? next : face.face;
          if (part < 0 || !std::isnan(value[static_cast<std::size_t>(part)]) || !known.contains(cell)) continue;
          double neighbour = unknown;
          if (other >= 0) {
            neighbour = value[static_cast<std::size_t>(other)];
          } else if (!cut.is_solid(cell) && !old.is_solid(cell) && old.find(cell) < 0) {
            neighbour = pressure(cell[0], cell[1], cell[2]);
          }
          if (std::isnan(neighbour)) continue;
          sum[static_cast<std::size_t>(part)] += piece.share * neighbour;
          weight[static_cast<std::size_t>(part)] += piece.share;
        }
      }
    }
    for (std::size_t part = 0; part < value.size(); ++part)
      if (weight[part] > 0) value[part] = sum[part] / weight[part];
  }
  for (const CutCell& cell : cut.cells())
    for (int part = cell.first_part; part < cell.first_part + cell.n_parts; ++part) {
      const double carried =
          std::isnan(value[static_cast<std::size_t>(part)]) ? 0 : value[static_cast<std::size_t>(part)];
      const int further = cut.parts()[static_cast<std::size_t>(part)].further_piece;
      if (further >= 0) now.piece_pressure[static_cast<std::size_t>(further)] = carried;
      if (part == cell.main_part && known.contains(cell.cell))
        guess(cell.cell[0], cell.cell[1], cell.cell[2]) = carried;
    }
}

void ImmersedBodies::fill_piece_ghosts(HaloExchange& halo, BodyGeometry& now) {
  if (block_.decomposition->n_ranks() == 1 && !has_periodic_direction(block_)) return;
  const CutCells& cut = now.cut();
  const Box mine = box_of(block_.sizes);
  Box known = mine;  // fields know fewer layers than are looked at
  for (int d = 0; d < 3; ++d) known.begin[d] -= block_.ghosts[d], known.end[d] += block_.ghosts[d];
  // Pieces of a cell stand in the same order on all ranks.
  std::vector<std::size_t> number(now.piece_pressure.size(), 0);
  int n_in_a_cell = 0;
  for (std::size_t f = 0; f < number.size(); ++f) {
    const auto cell_of = [&](std::size_t piece) {
      return cut.parts()[static_cast<std::size_t>(cut.further_parts()[piece])].cell;
    };
    number[f] = f > 0 && cell_of(f) == cell_of(f - 1) ? number[f - 1] + 1 : 0;
    n_in_a_cell = std::max(n_in_a_cell, static_cast<int>(number[f]) + 1);
  }
  MPI_Allreduce(MPI_IN_PLACE, &n_in_a_cell, 1, MPI_INT, MPI_MAX, block_.decomposition->communicator());
  while (static_cast<int>(exchanged_.size()) < n_in_a_cell) exchanged_.push_back(block_.new_field());
  if (n_in_a_cell == 0) return;
  std::vector<Field<double>*> fields;
  for (int n = 0; n < n_in_a_cell; ++n) fields.push_back(&exchanged_[static_cast<std::size_t>(n)]);
  const auto visit = [&](bool own, const auto& with) {
    for (std::size_t f = 0; f < number.size(); ++f) {
      const CellPart& part = cut.parts()[static_cast<std::size_t>(cut.further_parts()[f])];
      const auto& [i, j, k] = cut.cells()[static_cast<std::size_t>(part.cell)].cell;
      if (known.contains({i, j, k}) && mine.contains({i, j, k}) == own)
        with(exchanged_[number[f]](i, j, k), now.piece_pressure[f]);
    }
  };
  visit(true, [](double& place, double pressure) { place = pressure; });
  halo.exchange(fields, axis_margin);
  visit(false, [](double place, double& pressure) { pressure = place; });
}

/// Linear along d between the faces of the cell, with the slopes towards the neighbours of these across: pieces beside
/// an opening have their own mean velocities, and a velocity that is linear in space has to go through all of them
/// without divergence. With the mean of both faces in its place a part that is closed but for its opening gets a source
/// that does not fall with the step, and small steps drive the flow to and fro. Faces with a given velocity have it all
/// over.
double ImmersedBodies::velocity_in_opening(const BodyGeometry& now, const Triple& cell, const Eigen::Vector3d& at,
                                           int d, const Field<double>& velocity) const {
  const double along = 0.5 + (at[d] - block_.axis[d].centre[cell[d]]) * block_.axis[d].inverse_width[cell[d]];
  double mean = 0;
  for (const int side : {0, 1}) {
    Triple face = cell;
    face[d] -= 1 - side;
    const double own = velocity(face[0], face[1], face[2]);
    double there = own;
    const bool is_given = !block_.faces[d].contains(face[0], face[1], face[2]);
    for (int e = 0; e < block_.n_dimensions && !is_given; ++e) {
      const double offset = at[e] - block_.axis[e].centre[cell[e]];
      const int step = offset > 0 ? 1 : -1;
      Triple next = face;
      next[e] += step;
      const bool is_beyond = (next[e] < 0 && block_.decomposition->is_at_border(e, 0)) ||
                             (next[e] >= block_.sizes[e] && block_.decomposition->is_at_border(e, 1));
      if (e == d || is_beyond || !now.layer().is_known(d, next)) continue;
      const double seen = 1 - now.layer().sight().to_neighbour(d, face, e, step).blocked;
      there += seen * std::abs(offset) * block_.axis[e].inverse_distance[std::min(face[e], next[e])] *
               (velocity(next[0], next[1], next[2]) - own);
    }
    mean += (side == 0 ? 1 - along : along) * there;
  }
  return mean;
}

void ImmersedBodies::take_divergence(const BodyGeometry& now, double factor, const VectorField& velocity,
                                     const std::vector<double>& piece_velocity, Field<double>& source,
                                     std::vector<double>& piece_source) const {
  const CutCells& cut = now.cut();
  const Box mine = box_of(block_.sizes);
  std::vector<double> outflow(cut.parts().size(), 0.0);  // [m^3/s]
  for (const CutFace& face : cut.faces()) {
    const int d = face.direction, e = (d + 1) % 3, f = (d + 2) % 3;
    Triple next = face.face;
    ++next[d];
    if (!mine.contains(face.face) && !mine.contains(next)) continue;
    const double area = block_.axis[e].width[face.face[e]] * block_.axis[f].width[face.face[f]];
    const double through_middle = velocity[d](face.face[0], face.face[1], face.face[2]);
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
      double normal = through_middle;
      if (now.layer().ghost_of_piece(p) >= 0)
        normal = (1 - piece.opening) * piece_velocity[static_cast<std::size_t>(p)] + piece.opening * through_middle;
      normal += forcing_.piece_shift()[static_cast<std::size_t>(p)];
      const double flow = piece.share * area * normal;
      if (piece.lower_part >= 0) outflow[static_cast<std::size_t>(piece.lower_part)] += flow;
      if (piece.upper_part >= 0) outflow[static_cast<std::size_t>(piece.upper_part)] -= flow;
    }
  }
  for (const WallTriangle& wall : cut.walls()) {
    if (wall.outer_part == wall.inner_part) continue;
    const CutCell& cell =
        cut.cells()[static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(wall.outer_part)].cell)];
    if (!mine.contains(cell.cell)) continue;
    double flow = (1 - wall.opening) * wall.velocity.dot(wall.area);
    if (wall.opening > 0)
      for (int d = 0; d < block_.n_dimensions; ++d)
        flow += wall.opening * wall.area[d] * velocity_in_opening(now, cell.cell, wall.centroid, d, velocity[d]);
    outflow[static_cast<std::size_t>(wall.outer_part)] -= flow;
    outflow[static_cast<std::size_t>(wall.inner_part)] += flow;
  }
  const auto per_volume = [&](const Triple& cell) {
    double volume = 1;
    for (int d = 0; d < 3; ++d) volume *= block_.axis[d].width[cell[d]];
    return factor / volume;
  };
  for (const CutCell& cell : cut.cells()) {
    if (!mine.contains(cell.cell)) continue;
    source(cell.cell[0], cell.cell[1], cell.cell[2]) =
        cell.main_part < 0 ? 0 : per_volume(cell.cell) * outflow[static_cast<std::size_t>(cell.main_part)];
  }
  const std::vector<int>& listed = now.pieces().listed();
  piece_source.assign(listed.size(), 0.0);
  for (std::size_t n = 0; n < listed.size(); ++n) {
    const Triple& cell = now.pieces().split().cell[n];
    if (!mine.contains(cell)) continue;
    const int part = cut.further_parts()[static_cast<std::size_t>(listed[n])];
    piece_source[n] = per_volume(cell) * outflow[static_cast<std::size_t>(part)];
  }
}

void ImmersedBodies::keep_cut_faces(const BodyGeometry& now, const VectorField& velocity) {
  kept_.clear();
  for (const int index : now.pieces().faces_of_own_slope()) {
    const CutFace& face = now.cut().faces()[static_cast<std::size_t>(index)];
    if (!is_of_my_cells(face.direction, face.face)) continue;
    kept_.push_back(velocity[face.direction](face.face[0], face.face[1], face.face[2]));
  }
}

void ImmersedBodies::correct_cut_faces(const BodyGeometry& now, double step_over_density, const Field<double>& phi,
                                       const std::vector<double>& piece_phi, VectorField& velocity) const {
  std::size_t n = 0;
  for (const int index : now.pieces().faces_of_own_slope()) {
    const CutFace& face = now.cut().faces()[static_cast<std::size_t>(index)];
    if (!is_of_my_cells(face.direction, face.face)) continue;
    velocity[face.direction](face.face[0], face.face[1], face.face[2]) =
        kept_[n++] - step_over_density * now.pieces().middle_slope(index, phi, piece_phi);
  }
  for (const WallValue& solid : now.layer().solid())
    velocity[solid.component](solid.face[0], solid.face[1], solid.face[2]) = solid.wall_velocity;
}

void ImmersedBodies::still_inside(const BodyGeometry& now, const ActiveCells& whole, VectorField& velocity,
                                  Field<double>& pressure) const {
  const CutCells& cut = now.cut();
  const auto still = [&](const Triple& cell) {
    if (!cut.is_solid(cell) || cut.find(cell) >= 0) return;
    pressure(cell[0], cell[1], cell[2]) = 0;
    for (int d = 0; d < block_.n_dimensions; ++d)
      if (!now.layer().is_near(d, cell)) velocity[d](cell[0], cell[1], cell[2]) = 0;
  };
  for (int k = 0; k < block_.sizes[2]; ++k)
    for (int j = 0; j < block_.sizes[1]; ++j)
      for_each_interval(block_.cells, j, k, 0, block_.sizes[0], [&](int first, int last) {
        int i = first;  // the cells between those that are whole
        for_each_interval(whole, j, k, first, last, [&](int begin, int end) {
          for (; i < begin; ++i) still({i, j, k});
          i = end;
        });
        for (; i < last; ++i) still({i, j, k});
      });
}

double ImmersedBodies::courant_rate(const BodyGeometry& bodies) const {
  const CutCells& cut = bodies.cut();
  const Box mine = box_of(block_.sizes);
  double rate = 0;
  for (const WallTriangle& wall : cut.walls()) {
    const Triple& cell =
        cut.cells()[static_cast<std::size_t>(cut.parts()[static_cast<std::size_t>(wall.outer_part)].cell)].cell;
    if (!mine.contains(cell)) continue;
    double sum = 0;
    for (int d = 0; d < block_.n_dimensions; ++d)
      sum += std::abs(wall.velocity[d]) * block_.axis[d].inverse_width[cell[d]];
    rate = std::max(rate, sum);
  }
  return rate;
}

}  // namespace couplet::flow
