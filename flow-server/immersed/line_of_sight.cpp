#include "flow-server/immersed/line_of_sight.hpp"

namespace couplet::flow {

void LineOfSight::update() {
  first_sight_.clear();
  sights_.clear();
  for (const CutCell& cell : cut_.cells()) {
    const auto n = static_cast<std::size_t>(cell.n_parts), first = sights_.size();
    first_sight_.push_back(static_cast<int>(first));
    sights_.resize(first + n * n);
    if (n == 2) {
      // The second part sees what the first one sees, from the other side.
      Sight& there = sights_[first + 1] = look_between(cell.first_part, cell.first_part + 1);
      Sight& back = sights_[first + 2] = there;
      back.is_outer = there.surface >= 0 && !there.is_outer;
      continue;
    }
    for (std::size_t part = 0; part < n; ++part)
      for (std::size_t other = 0; other < n; ++other)
        if (part != other)
          sights_[first + part * n + other] =
              look_between(cell.first_part + static_cast<int>(part), cell.first_part + static_cast<int>(other));
  }
}

/// Parts of one cell; -1 where it is whole.
Sight LineOfSight::between(int part, int other) const {
  if (part == other || part < 0 || other < 0) return {};
  const auto cell = static_cast<std::size_t>(cut_.parts()[static_cast<std::size_t>(part)].cell);
  const CutCell& cut = cut_.cells()[cell];
  return sights_[static_cast<std::size_t>(first_sight_[cell] + (part - cut.first_part) * cut.n_parts + other -
                                          cut.first_part)];
}

Sight LineOfSight::look_between(int part, int other) const {
  const CutCell& cell = cut_.cells()[static_cast<std::size_t>(cut_.parts()[static_cast<std::size_t>(part)].cell)];
  Sight sight{.blocked = 1};
  double largest = -1, area = 0, open = 0;
  for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
    const WallTriangle& wall = cut_.walls()[static_cast<std::size_t>(w)];
    if (wall.outer_part == wall.inner_part || (wall.outer_part != part && wall.inner_part != part)) continue;
    const double size = wall.area.norm();
    const bool is_direct = wall.outer_part == other || wall.inner_part == other;
    if (is_direct) area += size, open += size * wall.opening;
    // The wall towards the other part, or any wall of this one where a third part lies between them.
    const double worth = is_direct ? 1 + size : size / (1 + size);
    if (worth > largest) largest = worth, sight.surface = wall.surface, sight.is_outer = wall.outer_part == part;
  }
  if (area > 0) sight.blocked = 1 - open / area;
  return sight;
}

Sight LineOfSight::across_cell(const Triple& cell, int d, const Triple& face, int other_d,
                               const Triple& other_face) const {
  const int index = cut_.find(cell);
  if (index < 0) return {};
  const auto& part = cut_.cells()[static_cast<std::size_t>(index)].part_at_face;
  const auto part_at = [&](int e, const Triple& at) {
    return part[static_cast<std::size_t>(e)][at[e] == cell[e] ? 1 : 0];
  };
  return between(part_at(d, face), part_at(other_d, other_face));
}

Sight LineOfSight::through(int from, int d, const Triple& next_face, int e, const Triple& cell,
                           const Triple& next) const {
  const int to = cut_.part_at(next, d, next_face);
  if (from < 0 && to < 0) return {};
  const bool is_up = next[e] > cell[e];
  const int index = cut_.find_face(e, is_up ? cell : next);
  if (index < 0) return {};
  const CutFace& door = cut_.faces()[static_cast<std::size_t>(index)];
  Sight best{.blocked = 2};
  for (int p = door.first_piece; p < door.first_piece + door.n_pieces; ++p) {
    const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
    const Sight first = between(from, is_up ? piece.lower_part : piece.upper_part);
    Sight second = between(is_up ? piece.upper_part : piece.lower_part, to);
    const Sight& worse = second.blocked > first.blocked ? second : first;
    if (worse.blocked < best.blocked) best = worse;
    if (best.blocked == 0) break;
  }
  return best;
}

Sight LineOfSight::to_neighbour(int d, const Triple& face, int e, int step) const {
  Triple next_face = face;
  next_face[e] += step;
  Triple upper = face;
  ++upper[d];
  if (e == d) return across_cell(step > 0 ? upper : face, d, face, d, next_face);
  Triple next = face, next_upper = upper;
  next[e] += step, next_upper[e] += step;
  const Sight below = through(cut_.part_at(face, d, face), d, next_face, e, face, next);
  if (below.blocked == 0) return below;
  const Sight above = through(cut_.part_at(upper, d, face), d, next_face, e, upper, next_upper);
  return above.blocked < below.blocked ? above : below;
}

bool LineOfSight::is_one_part(const Triple& cell) const {
  const int index = cut_.find(cell);
  return index < 0 || cut_.cells()[static_cast<std::size_t>(index)].n_parts == 1;
}

bool LineOfSight::is_plainly_free(int d, const Triple& face, int e, int step) const {
  Triple next = face;
  if (e == d) {
    if (step > 0) ++next[d];
    return is_one_part(next);
  }
  next[e] += step;
  return is_one_part(face) && is_one_part(next);
}

bool LineOfSight::sees_neighbour(const FacePiece& piece, int d, const Triple& face, int e, int step) const {
  Triple next = face, upper = face;
  next[e] += step, ++upper[d];
  Triple next_upper = upper;
  next_upper[e] += step;
  return through(piece.lower_part, d, next, e, face, next).blocked == 0 ||
         through(piece.upper_part, d, next, e, upper, next_upper).blocked == 0;
}

}  // namespace couplet::flow
