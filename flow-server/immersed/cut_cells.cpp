#include "flow-server/immersed/cut_cells.hpp"

#include <algorithm>

namespace couplet::flow {

namespace {

/// Pieces of faces below this share count for nothing.
constexpr double smallest_share = 1e-13;

Triple end_corner(const Triple& cell, int d, int side) {
  Triple corner = cell;
  corner[d] += side;
  return corner;
}

}  // namespace

CutCells::CutCells(const StretchedGrid& grid, const EdgeCrossings& crossings) : grid_(grid), crossings_(crossings) {
  const Box& cells = crossings.cells();
  Triple sizes, before;
  for (int d = 0; d < 3; ++d) {
    sizes[d] = std::max(cells.end[d], 1);
    before[d] = std::max(-cells.begin[d], 0) + 1;
  }
  place_ = Field<Place>(sizes, before);
}

void CutCells::update(std::span<const BodySurface> surfaces) {
  for (const CutCell& cut : cells_) place(cut.cell) = {};
  for (const CutFace& face : faces_) place(face.face) = {};
  cells_.clear(), parts_.clear(), faces_.clear(), pieces_.clear(), walls_.clear();
  middles_.clear(), middle_points_.clear(), further_parts_.clear();
  n_lone_crossings_ = 0;
  const Box& looked_at = crossings_.cells();
  std::vector<std::size_t> cells;  // by their number in the box looked at
  const auto n_x = static_cast<std::size_t>(looked_at.size(0)), n_y = static_cast<std::size_t>(looked_at.size(1));
  for (const EdgeCrossings::Edge& edge : crossings_.crossed()) {
    const int d = edge.direction, e1 = (d + 1) % 3, e2 = (d + 2) % 3;
    for (int a = -1; a <= 0; ++a)
      for (int b = -1; b <= 0; ++b) {
        Triple cell = edge.corner;
        cell[e1] += a, cell[e2] += b;
        if (!looked_at.contains(cell)) continue;
        int& seen = place(cell).cell;
        if (seen != 0) continue;
        seen = 1;  // its true place follows
        cells.push_back((static_cast<std::size_t>(cell[2] - looked_at.begin[2]) * n_y +
                         static_cast<std::size_t>(cell[1] - looked_at.begin[1])) *
                            n_x +
                        static_cast<std::size_t>(cell[0] - looked_at.begin[0]));
      }
  }
  std::sort(cells.begin(), cells.end());
  for (const std::size_t number : cells)
    add_cell(
        {static_cast<int>(number % n_x) + looked_at.begin[0], static_cast<int>(number / n_x % n_y) + looked_at.begin[1],
         static_cast<int>(number / n_x / n_y) + looked_at.begin[2]},
        surfaces);
}

void CutCells::add_cell(const Triple& cell, std::span<const BodySurface> surfaces) {
  const int cell_index = static_cast<int>(cells_.size());
  CutCell cut;
  cut.cell = cell;
  cut.first_part = static_cast<int>(parts_.size());
  const FacesOfCell faces{
      FaceCut(crossings_, 0, end_corner(cell, 0, 0)), FaceCut(crossings_, 0, end_corner(cell, 0, 1)),
      FaceCut(crossings_, 1, end_corner(cell, 1, 0)), FaceCut(crossings_, 1, end_corner(cell, 1, 1)),
      FaceCut(crossings_, 2, end_corner(cell, 2, 0)), FaceCut(crossings_, 2, end_corner(cell, 2, 1))};

  const ConnectedPieces connected(faces);
  cut.n_parts = connected.n_parts();
  for (int p = 0; p < cut.n_parts; ++p) parts_.push_back({.cell = cell_index});
  const auto part_of = [&](std::size_t face, int piece) -> CellPart& {
    return parts_[static_cast<std::size_t>(cut.first_part + connected.part_of(face, piece))];
  };

  // What is inside closed bodies: behind their chords, and where a corner is.
  for (std::size_t f = 0; f < 6; ++f)
    for (int c = 0; c < faces[f].n_chords(); ++c) {
      const Chord& chord = faces[f].chord(c);
      if (!surfaces[static_cast<std::size_t>(chord.surface())].is_closed) continue;
      part_of(f, chord.inner_piece).is_fluid = false;
    }
  for (int x = 0; x < 2; ++x)
    for (int y = 0; y < 2; ++y)
      for (int z = 0; z < 2; ++z)
        if (crossings_.is_inside({cell[0] + x, cell[1] + y, cell[2] + z}))
          parts_[static_cast<std::size_t>(cut.first_part + connected.part_at_corner(x, y, z))].is_fluid = false;

  // Faces: made by the first cell that comes, completed by the second.
  for (int d = 0; d < 3; ++d) {
    if (d == 2 && grid_.n_dimensions == 2) continue;
    const double area =
        (crossings_.position((d + 1) % 3, cell[(d + 1) % 3] + 1) -
         crossings_.position((d + 1) % 3, cell[(d + 1) % 3])) *
        (crossings_.position((d + 2) % 3, cell[(d + 2) % 3] + 1) - crossings_.position((d + 2) % 3, cell[(d + 2) % 3]));
    for (int side = 0; side < 2; ++side) {
      const auto f = static_cast<std::size_t>(2 * d + side);
      const FaceCut& given = faces[f];
      const Triple at = end_corner(cell, d, side - 1);
      int& face_place = place(at).face[static_cast<std::size_t>(d)];
      if (face_place == 0) {
        CutFace face{.direction = d, .face = at};
        face.first_piece = static_cast<int>(pieces_.size());
        face.n_pieces = given.n_pieces();
        face.centre_piece = face.first_piece + given.centre_piece();
        for (int p = 0; p < given.n_pieces(); ++p) {
          FacePiece piece{.share = given.share(p)};
          for (int t = 0; t < 2; ++t) {
            const int e = (d + 1 + t) % 3;
            piece.offset[static_cast<std::size_t>(t)] =
                (given.centroid(p)[t] - 0.5) * (crossings_.position(e, cell[e] + 1) - crossings_.position(e, cell[e]));
          }
          pieces_.push_back(piece);
        }
        // Towards the middle of the face: the chord that parts both sides there, or the last one before it.
        for (int c = 0; c < given.n_chords(); ++c) {
          const Chord& chord = given.chord(c);
          for (const bool is_outer : {true, false}) {
            const int index = is_outer ? chord.outer_piece : chord.inner_piece;
            FacePiece& piece = pieces_[static_cast<std::size_t>(face.first_piece + index)];
            const bool faces_centre = (is_outer ? chord.inner_piece : chord.outer_piece) == given.centre_piece();
            if (index == given.centre_piece() || (piece.surface >= 0 && !faces_centre)) continue;
            piece.surface = chord.surface();
            piece.is_outer = is_outer;
            piece.opening = chord.opening();
          }
        }
        faces_.push_back(face);
        face_place = static_cast<int>(faces_.size());
        n_lone_crossings_ += given.has_lone_crossing() ? 1 : 0;
      }
      const CutFace& face = faces_[static_cast<std::size_t>(face_place - 1)];
      for (int p = 0; p < face.n_pieces; ++p) {
        FacePiece& piece = pieces_[static_cast<std::size_t>(face.first_piece + p)];
        const int own = cut.first_part + connected.part_of(f, p);
        (side == 0 ? piece.upper_part : piece.lower_part) = own;
        const int middle = cut.first_part + connected.part_of(f, given.centre_piece());
        // A sheet that stands in a body does not open towards it.
        if (!parts_[static_cast<std::size_t>(own)].is_fluid || !parts_[static_cast<std::size_t>(middle)].is_fluid)
          piece.opening = 0;
        if (piece.share > smallest_share) parts_[static_cast<std::size_t>(own)].open_area += piece.share * area;
      }
      cut.part_at_face[static_cast<std::size_t>(d)][static_cast<std::size_t>(side)] =
          cut.first_part + connected.part_of(f, given.centre_piece());
    }
  }
  add_walls(cut, faces, connected);

  // The largest part takes the cell's place in the fields: where one flat wall cuts the cell, the one with its middle.
  double largest = 0;
  for (int p = cut.first_part; p < cut.first_part + cut.n_parts; ++p) {
    const CellPart& part = parts_[static_cast<std::size_t>(p)];
    if (part.is_fluid && part.open_area > largest) largest = part.open_area, cut.main_part = p;
  }
  for (int p = cut.first_part; p < cut.first_part + cut.n_parts; ++p) {
    CellPart& part = parts_[static_cast<std::size_t>(p)];
    if (p == cut.main_part || !part.is_fluid || part.open_area <= 0) continue;
    part.further_piece = static_cast<int>(further_parts_.size());
    further_parts_.push_back(p);
  }
  cells_.push_back(cut);
  place(cell).cell = static_cast<int>(cells_.size());
}

int CutCells::find(const Triple& cell) const {
  if (!crossings_.cells().contains(cell)) return -1;
  return place(cell).cell - 1;
}

int CutCells::find_face(int d, const Triple& face) const {
  const Box& cells = crossings_.cells();
  for (int e = 0; e < 3; ++e)
    if (face[e] < cells.begin[e] - (e == d ? 1 : 0) || face[e] >= cells.end[e]) return -1;
  return place(face).face[static_cast<std::size_t>(d)] - 1;
}

ActiveCells CutCells::whole(const ActiveCells& cells) const {
  std::size_t next = 0;  // of cells_, in the same order as rows
  const auto is_before = [](const Triple& cell, int j, int k) { return cell[2] < k || (cell[2] == k && cell[1] < j); };
  return ActiveCells::of_rows(cells.range(), [&](int j, int k, std::vector<Interval>& intervals) {
    std::vector<Interval> holes(crossings_.inside(j, k).begin(), crossings_.inside(j, k).end());
    while (next < cells_.size() && is_before(cells_[next].cell, j, k)) ++next;
    for (; next < cells_.size() && cells_[next].cell[1] == j && cells_[next].cell[2] == k; ++next)
      holes.push_back({cells_[next].cell[0], cells_[next].cell[0] + 1});
    std::sort(holes.begin(), holes.end(), [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
    for (const Interval& row : cells.row(j, k)) {
      int begin = row.begin;
      for (const Interval& hole : holes) {
        if (std::min(hole.begin, row.end) > begin) intervals.push_back({begin, std::min(hole.begin, row.end)});
        begin = std::max(begin, hole.end);
      }
      if (begin < row.end) intervals.push_back({begin, row.end});
    }
  });
}

bool CutCells::is_solid(const Triple& cell) const {
  const int index = find(cell);
  if (index >= 0) return cells_[static_cast<std::size_t>(index)].main_part < 0;
  return crossings_.cells().contains(cell) && crossings_.is_inside(cell);
}

bool CutCells::is_face_solid(int d, const Triple& face) const {
  const int index = find_face(d, face);
  if (index >= 0) {
    const FacePiece& piece = pieces_[static_cast<std::size_t>(faces_[static_cast<std::size_t>(index)].centre_piece)];
    const int part = piece.lower_part >= 0 ? piece.lower_part : piece.upper_part;
    return !parts_[static_cast<std::size_t>(part)].is_fluid;
  }
  Triple next = face;
  ++next[d];
  return (crossings_.cells().contains(face) && crossings_.is_inside(face)) ||
         (crossings_.cells().contains(next) && crossings_.is_inside(next));
}

int CutCells::part_at(const Triple& cell, int d, const Triple& face) const {
  const int index = find(cell);
  if (index < 0) return -1;
  return cells_[static_cast<std::size_t>(index)].part_at_face[static_cast<std::size_t>(d)][face[d] == cell[d] ? 1 : 0];
}

double CutCells::opening_between(int part, int other) const {
  if (part == other) return 1;
  const CutCell& cut = cells_[static_cast<std::size_t>(parts_[static_cast<std::size_t>(part)].cell)];
  double area = 0, open = 0;
  for (int w = cut.first_wall; w < cut.first_wall + cut.n_walls; ++w) {
    const WallTriangle& wall = walls_[static_cast<std::size_t>(w)];
    if ((wall.outer_part != part || wall.inner_part != other) && (wall.outer_part != other || wall.inner_part != part))
      continue;
    area += wall.area.norm();
    open += wall.area.norm() * wall.opening;
  }
  return area > 0 ? open / area : 0;
}

/// By the theorem of Gauss, n V = integral of x . dA in n dimensions, with x from the middle of the cell. Bulges of a
/// sheet between its chords and free edges leave a part a little more or less than it has: never less than nothing.
double CutCells::fluid_volume(const CutCell& cell) const {
  Eigen::Vector3d middle, width;
  for (int d = 0; d < 3; ++d) {
    const double start = crossings_.position(d, cell.cell[d]), end = crossings_.position(d, cell.cell[d] + 1);
    middle[d] = 0.5 * (start + end), width[d] = end - start;
  }
  const auto is_fluid = [&](int part) { return part >= 0 && parts_[static_cast<std::size_t>(part)].is_fluid; };
  double flux = 0;
  for (int d = 0; d < grid_.n_dimensions; ++d)
    for (const int side : {0, 1}) {
      Triple face = cell.cell;
      face[d] -= 1 - side;
      const int index = find_face(d, face);
      if (index < 0) continue;
      const CutFace& cut = faces_[static_cast<std::size_t>(index)];
      for (int p = cut.first_piece; p < cut.first_piece + cut.n_pieces; ++p) {
        const FacePiece& piece = pieces_[static_cast<std::size_t>(p)];
        if (is_fluid(side == 0 ? piece.upper_part : piece.lower_part)) flux += 0.5 * width.prod() * piece.share;
      }
    }
  for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
    const WallTriangle& wall = walls_[static_cast<std::size_t>(w)];
    const double outwards = wall.area.dot(wall.centroid - middle);
    if (is_fluid(wall.outer_part)) flux -= outwards;
    if (is_fluid(wall.inner_part)) flux += outwards;
  }
  return std::clamp(flux / grid_.n_dimensions, 0.0, width.prod());
}

}  // namespace couplet::flow
