// The walls inside cut cells.

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "flow-server/immersed/cut_cells.hpp"

namespace couplet::flow {

namespace {

/// An end of a chord: a corner of the wall's outline.
struct WallPoint {
  std::array<WeighedPoint, 2> between{};
  Eigen::Vector3d position;
  bool is_bend, is_crossing;  // of a sharp edge with the face; of two surfaces

  WallPoint(const Chord& chord, bool is_from)
      : position(is_from ? chord.from_position : chord.to_position), is_bend(chord.has_bend[is_from ? 0 : 1]) {
    const double share = is_from ? chord.from_share : chord.to_share;
    between = {WeighedPoint{chord.from, 1 - share}, WeighedPoint{chord.to, share}};
    is_crossing = share > 0 && share < 1;
  }
  template <class Value>
  Value mean(Value SurfacePoint::*of) const {
    return between[0].weight * (between[0].point->*of) + between[1].weight * (between[1].point->*of);
  }
};

/// An end of a chord where another surface crosses it. Seen from outside the cell the wall's outline runs to the middle
/// from there, or from the middle to there.
struct LooseEnd {
  WallPoint point;
  bool leads_here;  // from the middle
};

}  // namespace

void CutCells::add_walls(CutCell& cut, const FacesOfCell& faces, const ConnectedPieces& connected) {
  cut.first_wall = static_cast<int>(walls_.size());
  /// The wall of a surface between two parts of the cell.
  struct Wall {
    int surface, outer_part, inner_part;
    bool is_bent = false;
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();  // of the middle
    double opening = 0;
    int n = 0, middle = 0;
  };
  std::vector<Wall> walls;
  struct Side {
    const Chord* chord;
    std::size_t wall;
    bool is_end;  // on a face at the end of the cell
  };
  std::vector<Side> sides;
  for (std::size_t f = 0; f < 6; ++f)
    for (int c = 0; c < faces[f].n_chords(); ++c) {
      const Chord& chord = faces[f].chord(c);
      const int outer = cut.first_part + connected.part_of(f, chord.outer_piece);
      const int inner = cut.first_part + connected.part_of(f, chord.inner_piece);
      const auto found = std::find_if(walls.begin(), walls.end(), [&](const Wall& wall) {
        return wall.surface == chord.surface() && wall.outer_part == outer && wall.inner_part == inner;
      });
      sides.push_back({&chord, static_cast<std::size_t>(found - walls.begin()), f % 2 == 1});
      if (found == walls.end()) walls.push_back({.surface = chord.surface(), .outer_part = outer, .inner_part = inner});
      walls[sides.back().wall].is_bent |= chord.has_bend[0] || chord.has_bend[1];
    }
  // The mean of bends, which lies on the sharp edge: then all triangles lie in the planes beside it. Without bends that
  // of all corners: a crossing of an edge is an end of two chords, on both faces beside it; a place where two surfaces
  // cross is the end of one, and of the line to the next such place.
  const auto for_each_corner = [&](const auto& visit) {
    for (const Side& side : sides)
      for (const bool is_from : {true, false}) {
        const WallPoint point(*side.chord, is_from);
        if (!walls[side.wall].is_bent || point.is_bend) visit(side.wall, point, point.is_crossing ? 2 : 1);
      }
  };
  for_each_corner([&](std::size_t w, const WallPoint& point, int times) {
    Wall& wall = walls[w];
    wall.position += times * point.position;
    wall.velocity += times * point.mean(&SurfacePoint::velocity);
    wall.opening += times * point.mean(&SurfacePoint::opening);
    wall.n += times;
  });
  for (std::size_t w = 0; w < walls.size(); ++w) {
    Wall& wall = walls[w];
    wall.position /= wall.n, wall.velocity /= wall.n, wall.opening /= wall.n;
    wall.middle = static_cast<int>(middles_.size());
    const std::size_t first = middle_points_.size();
    for_each_corner([&](std::size_t of, const WallPoint& point, int times) {
      if (of != w) return;
      for (const WeighedPoint& end : point.between)
        if (end.weight > 0) middle_points_.push_back({end.point, times * end.weight / wall.n});
    });
    middles_.push_back({static_cast<int>(first), static_cast<int>(middle_points_.size() - first)});
  }
  // From two corners of the outline to the middle; seen from outside the wall's outer side they run counterclockwise.
  const auto add = [&](const Wall& wall, const WallPoint& from, const WallPoint& to) {
    WallTriangle triangle;
    triangle.surface = wall.surface;
    triangle.outer_part = wall.outer_part, triangle.inner_part = wall.inner_part;
    triangle.middle = wall.middle;
    std::size_t n = 0;
    for (const WallPoint* point : {&from, &to})
      for (const WeighedPoint& end : point->between)
        if (end.weight > 0) triangle.end[n++] = {end.point, end.weight / 3};
    const Eigen::Vector3d a = from.position - wall.position, b = to.position - wall.position;
    triangle.area = 0.5 * b.cross(a);
    triangle.centroid = wall.position + (a + b) / 3;
    triangle.velocity = (from.mean(&SurfacePoint::velocity) + to.mean(&SurfacePoint::velocity) + wall.velocity) / 3;
    if (parts_[static_cast<std::size_t>(wall.outer_part)].is_fluid &&
        parts_[static_cast<std::size_t>(wall.inner_part)].is_fluid)
      triangle.opening = (from.mean(&SurfacePoint::opening) + to.mean(&SurfacePoint::opening) + wall.opening) / 3;
    walls_.push_back(triangle);
  };
  std::vector<std::pair<const Wall*, LooseEnd>> loose;
  for (const auto& [chord, w, is_end] : sides) {
    const Wall& wall = walls[w];
    const WallPoint from(*chord, true), to(*chord, false);
    // The outer piece runs counterclockwise from `from` to `to`; seen from outside the cell that is so on the faces at
    // the ends of the cell, and the other way around on those at its start.
    add(wall, is_end ? from : to, is_end ? to : from);
    if (from.is_crossing) loose.push_back({&wall, {from, !is_end}});
    if (to.is_crossing) loose.push_back({&wall, {to, is_end}});
  }
  // Along the lines in which surfaces cross: from a loose end to the next one of the same wall.
  for (auto here = loose.begin(); here != loose.end(); ++here) {
    if (!here->first || !here->second.leads_here) continue;
    const auto next = std::find_if(loose.begin(), loose.end(), [&](const auto& other) {
      return other.first == here->first && !other.second.leads_here;
    });
    if (next == loose.end()) continue;
    add(*here->first, here->second.point, next->second.point);
    next->first = nullptr, here->first = nullptr;
  }
  cut.n_walls = static_cast<int>(walls_.size()) - cut.first_wall;
}

}  // namespace couplet::flow
