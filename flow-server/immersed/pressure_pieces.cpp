#include "flow-server/immersed/pressure_pieces.hpp"

#include <cmath>

namespace couplet::flow {

namespace {

/// Smaller pieces of faces count for nothing: they are round-off of the crossings.
constexpr double smallest_open_share = 1e-13;
/// Keeps the conductance of a wide open edge finite.
constexpr double least_closed = 0.02;

Triple next_of(const CutFace& face) {
  Triple next = face.face;
  ++next[face.direction];
  return next;
}

}  // namespace

bool PressurePieces::is_given(const Triple& cell) const {
  for (int d = 0; d < block_.n_dimensions; ++d)
    if (cell[d] < -1 || cell[d] > block_.sizes[d]) return false;
  return true;
}

bool PressurePieces::is_fluid(int part, const Triple& cell) const {
  return part >= 0 ? cut_.parts()[static_cast<std::size_t>(part)].is_fluid : !cut_.is_solid(cell);
}

PressureUnknown PressurePieces::unknown_of(int part, const Triple& cell) const {
  const int further = part < 0 ? -1 : cut_.parts()[static_cast<std::size_t>(part)].further_piece;
  return {cell, further < 0 ? -1 : place_in_list_[static_cast<std::size_t>(further)]};
}

void PressurePieces::update(std::span<const BodySurface> surfaces) {
  shares_.clear();
  split_.cell.clear(), split_.links.clear();
  listed_.clear();
  place_in_list_.assign(cut_.further_parts().size(), -1);
  for (std::size_t f = 0; f < cut_.further_parts().size(); ++f) {
    const CellPart& part = cut_.parts()[static_cast<std::size_t>(cut_.further_parts()[f])];
    const Triple& cell = cut_.cells()[static_cast<std::size_t>(part.cell)].cell;
    if (!is_given(cell)) continue;
    place_in_list_[f] = static_cast<int>(split_.cell.size());
    split_.cell.push_back(cell);
    listed_.push_back(static_cast<int>(f));
  }
  faces_of_own_slope_.clear();
  slope_terms_.clear(), first_slope_term_.assign(1, 0);
  for (std::size_t f = 0; f < cut_.faces().size(); ++f) {
    add_face(cut_.faces()[f]);
    add_middle_slope(cut_.faces()[f]);
    if (!has_plain_slope(cut_.faces()[f])) faces_of_own_slope_.push_back(static_cast<int>(f));
  }
  for (const CutCell& cut : cut_.cells()) add_free_edges(cut, surfaces);
}

void PressurePieces::add_face(const CutFace& face) {
  const int d = face.direction;
  const Triple next = next_of(face);
  if (!is_given(face.face) || !is_given(next)) return;
  const Box mine = box_of(block_.sizes);
  // A face that the flow knows nothing of, between solid cells or beyond a border, stays closed.
  const Box& known = block_.faces[d].range();
  const bool is_known = known.contains(face.face);
  const bool is_open = !is_known || block_.faces[d].contains(face.face[0], face.face[1], face.face[2]);
  const int e = (d + 1) % 3, f = (d + 2) % 3;
  const double area = block_.axis[e].width[face.face[e]] * block_.axis[f].width[face.face[f]];
  double share = 0;
  for (int p = face.first_piece; p < face.first_piece + face.n_pieces && is_open; ++p) {
    const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
    if (piece.share < smallest_open_share || !is_fluid(piece.lower_part, face.face) ||
        !is_fluid(piece.upper_part, next))
      continue;
    const PressureUnknown lower = unknown_of(piece.lower_part, face.face), upper = unknown_of(piece.upper_part, next);
    if (lower.piece < 0 && upper.piece < 0) {
      share += piece.share;
    } else if (mine.contains(face.face) || mine.contains(next)) {
      split_.links.push_back({lower, upper, piece.share * area * block_.axis[d].inverse_control_width[face.face[d]]});
    }
  }
  shares_.push_back({d, face.face, static_cast<float>(share)});
}

double PressurePieces::conductance(const WallTriangle& wall, const Triple& cell,
                                   std::span<const BodySurface> surfaces) const {
  if (wall.opening <= 0 || wall.outer_part == wall.inner_part || !is_fluid(wall.outer_part, cell) ||
      !is_fluid(wall.inner_part, cell))
    return 0;
  double square = 0;  // width of the cell along the wall's normal, times its area
  for (int d = 0; d < block_.n_dimensions; ++d) square += std::pow(wall.area[d] * block_.axis[d].width[cell[d]], 2);
  if (square == 0) return 0;
  const double area = wall.area.norm();
  return surfaces[static_cast<std::size_t>(wall.surface)].edge_conductance * area * area / std::sqrt(square) *
         wall.opening / (1 - wall.opening + least_closed);
}

void PressurePieces::add_free_edges(const CutCell& cut, std::span<const BodySurface> surfaces) {
  if (!box_of(block_.sizes).contains(cut.cell)) return;
  for (int w = cut.first_wall; w < cut.first_wall + cut.n_walls; ++w) {
    const WallTriangle& wall = cut_.walls()[static_cast<std::size_t>(w)];
    const double through = conductance(wall, cut.cell, surfaces);
    if (through == 0) continue;
    const PressureUnknown outer = unknown_of(wall.outer_part, cut.cell), inner = unknown_of(wall.inner_part, cut.cell);
    if (outer.piece != inner.piece) split_.links.push_back({outer, inner, through});
  }
}

double PressurePieces::value_at(int part, const Triple& cell, const Field<double>& cells,
                                std::span<const double> pieces) const {
  const int further = part < 0 ? -1 : cut_.parts()[static_cast<std::size_t>(part)].further_piece;
  return further < 0 ? cells(cell[0], cell[1], cell[2]) : pieces[static_cast<std::size_t>(further)];
}

double PressurePieces::slope(const CutFace& face, const FacePiece& piece, const Field<double>& cells,
                             std::span<const double> pieces) const {
  const Triple next = next_of(face);
  if (!is_fluid(piece.lower_part, face.face) || !is_fluid(piece.upper_part, next)) return 0;
  return (value_at(piece.upper_part, next, cells, pieces) - value_at(piece.lower_part, face.face, cells, pieces)) *
         block_.axis[face.direction].inverse_control_width[face.face[face.direction]];
}

double PressurePieces::slope_between_cells(int d, const Triple& face, const Field<double>& cells) const {
  Triple next = face;
  ++next[d];
  return (cells(next[0], next[1], next[2]) - cells(face[0], face[1], face[2])) *
         block_.axis[d].inverse_control_width[face[d]];
}

double PressurePieces::slope_at(int d, const Triple& face, const Field<double>& cells,
                                std::span<const double> pieces) const {
  const int index = cut_.find_face(d, face);
  if (index >= 0) return middle_slope(index, cells, pieces);
  Triple next = face;
  ++next[d];
  return cut_.is_solid(face) || cut_.is_solid(next) ? 0 : slope_between_cells(d, face, cells);
}

bool PressurePieces::joins_cells(const CutFace& face, const FacePiece& piece) const {
  const auto is_place = [&](int part, const Triple& cell) {
    return is_fluid(part, cell) && (part < 0 || cut_.parts()[static_cast<std::size_t>(part)].further_piece < 0);
  };
  return is_place(piece.lower_part, face.face) && is_place(piece.upper_part, next_of(face));
}

void PressurePieces::add_middle_slope(const CutFace& face) {
  const Triple next = next_of(face);
  // Cells are looked at one layer farther than pressures are known: no slope there, which nobody asks for.
  const Box known = box_of(block_.sizes).grown(block_.ghosts);
  if (!known.contains(face.face) || !known.contains(next)) {
    first_slope_term_.push_back(static_cast<int>(slope_terms_.size()));
    return;
  }
  const auto further_of = [&](int part) {
    return part < 0 ? -1 : cut_.parts()[static_cast<std::size_t>(part)].further_piece;
  };
  const std::size_t first = slope_terms_.size();
  double area = 0;
  const auto add = [&](const FacePiece& piece, double weight) {
    if (weight <= 0 || !is_fluid(piece.lower_part, face.face) || !is_fluid(piece.upper_part, next)) return;
    slope_terms_.push_back({{face.face, further_of(piece.lower_part)}, {next, further_of(piece.upper_part)}, weight});
    area += weight;
  };
  for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
    const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
    add(piece, p == face.centre_piece ? piece.share : piece.share * piece.opening);
  }
  if (area == 0) add(cut_.pieces()[static_cast<std::size_t>(face.centre_piece)], 1);
  const double over = block_.axis[face.direction].inverse_control_width[face.face[face.direction]];
  for (std::size_t t = first; t < slope_terms_.size(); ++t) slope_terms_[t].weight *= over / area;
  first_slope_term_.push_back(static_cast<int>(slope_terms_.size()));
}

double PressurePieces::middle_slope(int face, const Field<double>& cells, std::span<const double> pieces) const {
  const auto value = [&](const PressureUnknown& at) {
    return at.piece < 0 ? cells(at.cell[0], at.cell[1], at.cell[2]) : pieces[static_cast<std::size_t>(at.piece)];
  };
  double sum = 0;
  const auto f = static_cast<std::size_t>(face);
  for (int t = first_slope_term_[f]; t < first_slope_term_[f + 1]; ++t) {
    const SlopeTerm& term = slope_terms_[static_cast<std::size_t>(t)];
    sum += term.weight * (value(term.upper) - value(term.lower));
  }
  return sum;
}

bool PressurePieces::has_plain_slope(const CutFace& face) const {
  for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p)
    if (p != face.centre_piece && cut_.pieces()[static_cast<std::size_t>(p)].opening > 0) return false;
  return joins_cells(face, cut_.pieces()[static_cast<std::size_t>(face.centre_piece)]);
}

}  // namespace couplet::flow
