// How much room there is before walls, and what holds where there is too little.

#include <algorithm>

#include "flow-server/immersed/wall_layer.hpp"

namespace couplet::flow {

namespace {

/// Balls from the middle of the wall in a cell are wider by so many cells than those from other points of it, and float
/// so many cells above it: without touching the triangles around they are found empty at less than half the cost, and
/// what stands nearer than that stands in the cell, or cuts cells beside it.
constexpr double more_from_the_middle = 3, above = 0.35;

}  // namespace

/// Of the cell with a point that lies some cells from the given one at most.
Triple WallLayer::cell_of(const Eigen::Vector3d& point, Triple cell) const {
  for (int d = 0; d < block_.n_dimensions; ++d) {
    const AxisValues& end = block_.axis[d].face;
    while (cell[d] < block_.sizes[d] + axis_margin - 1 && end[cell[d]] < point[d]) ++cell[d];
    while (cell[d] > 1 - axis_margin && end[cell[d] - 1] >= point[d]) --cell[d];
  }
  return cell;
}

/// Width of the gap before a wall in units of `width`, `most` at most. Most walls have nothing before them: a larger
/// ball from the middle of a cell's wall says so for all points of that wall at once.
double WallLayer::gap_before(const ClosestPoint& wall, const Eigen::Vector3d& away, double width, double most,
                             const NearbyWalls& nearby, const Triple& near_cell) {
  if (!nearby.surfaces.is_only(wall.surface)) return nearest_.gap(wall, away, most * width) / width;
  const int index = cut_.find(cell_of({wall.position[0], wall.position[1], wall.position[2]}, near_cell));
  if (index >= 0) {
    const bool is_outer = away.dot(nearest_.normal(wall)) > 0;
    Clearness& known = clearness_[2 * static_cast<std::size_t>(index) + (is_outer ? 1 : 0)];
    if (known == Clearness::unknown)
      known = is_clear_before(cut_.cells()[static_cast<std::size_t>(index)], wall.surface, is_outer)
                  ? Clearness::clear
                  : Clearness::not_clear;
    if (known == Clearness::clear) return most;
  }
  return nearest_.gap(wall, away, most * width) / width;
}

/// Whether nothing stands near before one side of the wall in a cell with no other wall. Depends on the cell alone.
bool WallLayer::is_clear_before(const CutCell& cell, int surface, bool is_outer) {
  if (cell.n_parts > 2) return false;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double area = 0;
  for (int w = cell.first_wall; w < cell.first_wall + cell.n_walls; ++w) {
    const WallTriangle& wall = cut_.walls()[static_cast<std::size_t>(w)];
    if (wall.surface != surface) return false;
    const double size = wall.area.norm();
    middle += size * wall.centroid;
    area += size;
  }
  if (area <= 0) return false;
  double widest = 0;
  for (int d = 0; d < block_.n_dimensions; ++d)
    widest = std::max(widest, 1 / block_.axis[d].inverse_width[cell.cell[d]]);
  NearbyWalls asked_once;
  const ClosestPoint foot = nearest_.on(surface, middle / area, widest, asked_once);
  if (!foot.is_found()) return false;
  const double radius = 0.5 * (widest_gap(blend_of(nearest_.surface(surface))) + more_from_the_middle) * widest;
  return nearest_.is_empty(foot, (is_outer ? radius : -radius) * nearest_.normal(foot), radius - above * widest);
}

/// The wall's value alone where there is nothing beside it.
void WallLayer::set_room(WallValue& value, double room, const Neighbours& beside) {
  if (room >= 1 || beside.n == 0) return;
  value.room = room;
  value.first_beside = static_cast<int>(beside_.size());
  value.n_beside = beside.n;
  beside_.insert(beside_.end(), beside.face.begin(), beside.face.begin() + beside.n);
}

double WallLayer::mean_beside(const WallValue& value, const Field<double>& field) const {
  double sum = 0;
  for (const Triple& face : beside(value)) sum += field(face[0], face[1], face[2]);
  return sum / value.n_beside;
}

double WallLayer::imposed(const WallValue& value, const Field<double>& velocity) const {
  if (value.room >= 1) return value_of(value, velocity);
  return value.room * value_of(value, velocity) + (1 - value.room) * mean_beside(value, velocity);
}

}  // namespace couplet::flow
