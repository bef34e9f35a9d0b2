// The walls inside cut cells.

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "flow-server/immersed/cut_cells.hpp"

namespace couplet::flow {

namespace {

/// A point of the wall on a chord.
struct WallPoint {
  std::array<WeighedCrossing, 2> between{};
  Eigen::Vector3d position;

  WallPoint(const Chord& chord, bool is_from) : position(is_from ? chord.from_position : chord.to_position) {
    const double share = is_from ? chord.from_share : chord.to_share;
    between = {WeighedCrossing{chord.from, 1 - share}, WeighedCrossing{chord.to, share}};
  }
  template <class Value>
  Value mean(Value EdgeCrossing::*of) const {
    return between[0].weight * (between[0].crossing->*of) + between[1].weight * (between[1].crossing->*of);
  }
};

/// An end of a chord's part where another surface crosses it. Seen from outside the cell the wall's outline runs to the
/// middle from there, or from the middle to there.
struct LooseEnd {
  WallPoint point;
  bool leads_here;  // from the middle
};

}  // namespace

void CutCells::add_walls(CutCell& cut, const FacesOfCell& faces, const ConnectedPieces& connected) {
  cut.first_wall = static_cast<int>(walls_.size());
  /// The wall of a surface, or a part of it that has the same parts of the cell beside it.
  struct Wall {
    int surface, outer_part, inner_part;
    Eigen::Vector3d position, velocity;  // of the middle
    double opening;
    int n, middle;
  };
  std::array<Wall, 6 * FaceCut::most_parts> walls;
  std::size_t n_walls = 0;
  const auto is_crossed = [&](int surface) {
    for (const FaceCut& face : faces)
      for (int c = 0; c < face.n_chords(); ++c)
        if (face.chord(c).surface() == surface && face.chord(c).is_part()) return true;
    return false;
  };
  bool has_crossings = false;  // of walls of two surfaces
  for (const FaceCut& face : faces)
    for (int c = 0; c < face.n_chords(); ++c) has_crossings = has_crossings || face.chord(c).is_part();
  const auto wall_of = [&](std::size_t f, const Chord& chord) -> Wall& {
    const int surface = chord.surface();
    const int outer = cut.first_part + connected.part_of(f, chord.outer_piece);
    const int inner = cut.first_part + connected.part_of(f, chord.inner_piece);
    const bool is_parted = has_crossings && is_crossed(surface);
    std::size_t w = 0;
    while (w < n_walls && (walls[w].surface != surface ||
                           (is_parted && (walls[w].outer_part != outer || walls[w].inner_part != inner))))
      ++w;
    if (w == n_walls)
      walls[n_walls++] = {surface, outer, inner, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0, 0, 0};
    return walls[w];
  };
  // Each crossing is an end of two chords, on both faces beside its edge: the mean over the ends is that over
  // crossings. A place where two surfaces cross is the end of one, and of the line to the next such place.
  const auto times = [](double share) { return share > 0 && share < 1 ? 2 : 1; };
  for (std::size_t f = 0; f < 6; ++f)
    for (int c = 0; c < faces[f].n_chords(); ++c) {
      const Chord& chord = faces[f].chord(c);
      Wall& wall = wall_of(f, chord);
      for (const bool is_from : {true, false}) {
        const WallPoint point(chord, is_from);
        const int n = times(is_from ? chord.from_share : chord.to_share);
        wall.position += n * point.position;
        wall.velocity += n * point.mean(&EdgeCrossing::velocity);
        wall.opening += n * point.mean(&EdgeCrossing::opening);
        wall.n += n;
      }
    }
  for (std::size_t w = 0; w < n_walls; ++w) {
    Wall& wall = walls[w];
    wall.position /= wall.n, wall.velocity /= wall.n, wall.opening /= wall.n;
    wall.middle = static_cast<int>(middles_.size());
    const std::size_t first = middle_crossings_.size();
    for (std::size_t f = 0; f < 6; ++f)
      for (int c = 0; c < faces[f].n_chords(); ++c) {
        const Chord& chord = faces[f].chord(c);
        if (&wall_of(f, chord) != &wall) continue;
        for (const bool is_from : {true, false}) {
          const int n = times(is_from ? chord.from_share : chord.to_share);
          for (const WeighedCrossing& crossing : WallPoint(chord, is_from).between)
            if (crossing.weight > 0) middle_crossings_.push_back({crossing.crossing, n * crossing.weight / wall.n});
        }
      }
    middles_.push_back({static_cast<int>(first), static_cast<int>(middle_crossings_.size() - first)});
  }
  // From two points of the outline to the middle; seen from outside the wall's outer side they run counterclockwise.
  const auto add = [&](const Wall& wall, int outer_part, int inner_part, const WallPoint& from, const WallPoint& to) {
    WallTriangle triangle;
    triangle.surface = wall.surface;
    triangle.outer_part = outer_part, triangle.inner_part = inner_part;
    triangle.middle = wall.middle;
    std::size_t n = 0;
    for (const WallPoint* point : {&from, &to})
      for (const WeighedCrossing& crossing : point->between)
        if (crossing.weight > 0) triangle.end[n++] = {crossing.crossing, crossing.weight / 3};
    const Eigen::Vector3d a = from.position - wall.position, b = to.position - wall.position;
    triangle.area = 0.5 * b.cross(a);
    triangle.centroid = wall.position + (a + b) / 3;
    triangle.velocity = (from.mean(&EdgeCrossing::velocity) + to.mean(&EdgeCrossing::velocity) + wall.velocity) / 3;
    if (parts_[static_cast<std::size_t>(outer_part)].is_fluid && parts_[static_cast<std::size_t>(inner_part)].is_fluid)
      triangle.opening = (from.mean(&EdgeCrossing::opening) + to.mean(&EdgeCrossing::opening) + wall.opening) / 3;
    walls_.push_back(triangle);
  };
  std::vector<std::pair<const Wall*, LooseEnd>> loose;
  for (std::size_t f = 0; f < 6; ++f)
    for (int c = 0; c < faces[f].n_chords(); ++c) {
      const Chord& chord = faces[f].chord(c);
      const Wall& wall = wall_of(f, chord);
      const WallPoint from(chord, true), to(chord, false);
      // The outer piece runs counterclockwise from `from` to `to`; seen from outside the cell that is so on the faces
      // at the ends of the cell, and the other way around on those at its start.
      const bool is_end = f % 2 == 1;
      add(wall, cut.first_part + connected.part_of(f, chord.outer_piece),
          cut.first_part + connected.part_of(f, chord.inner_piece), is_end ? from : to, is_end ? to : from);
      if (chord.from_share > 0) loose.push_back({&wall, {from, !is_end}});
      if (chord.to_share < 1) loose.push_back({&wall, {to, is_end}});
    }
  // Along the lines in which surfaces cross: from a loose end to the next one of the same part of the wall.
  for (auto here = loose.begin(); here != loose.end(); ++here) {
    if (!here->first || !here->second.leads_here) continue;
    const auto next = std::find_if(loose.begin(), loose.end(), [&](const auto& other) {
      return other.first == here->first && !other.second.leads_here;
    });
    if (next == loose.end()) continue;
    add(*here->first, here->first->outer_part, here->first->inner_part, here->second.point, next->second.point);
    next->first = nullptr, here->first = nullptr;
  }
  cut.n_walls = static_cast<int>(walls_.size()) - cut.first_wall;
}

}  // namespace couplet::flow
