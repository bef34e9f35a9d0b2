#include "flow-server/immersed/wall_layer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace couplet::flow {

namespace {

/// Nearer to the wall than this share of a cell its normal is the direction away from it.
constexpr double on_the_wall = 1e-3;
/// The cosine is 1 there, and 0, but for round-off, where the nearest point lies on an edge in the plane of its
/// triangle.
constexpr double right_behind = 0.5;
/// Faces within so many cells of the surface that blocks a sight are those that are seen through it.
constexpr double reach_of_ghosts = 3;
/// Surfaces stand off the chords between crossings by less than this share of a cell where they are resolved.
constexpr double chord_sagitta = 0.2;
/// Weights that sum to no more than this are none to speak of.
constexpr double hidden = 0.2;
/// In gaps the blend shrinks, so that at least one cell of it is left to the equations, to this share of itself; and
/// images stand in the middle, no nearer to the place they are for, or to the wall of a ghost, than this [cells].
constexpr double narrowest_blend = 0.25, nearest_image = 0.5, nearest_image_of_ghost = 0.75;
/// Blocked by more than this a link is none for interpolation.
constexpr double blocks = 0.5;

Eigen::Vector3d vector(const Point& point) {
  return {point[0], point[1], point[2]};
}

/// What gaps of some cells' width leave room for: an image on either side from 2 cells on, none below 1.
double room_in(double gap) {
  return std::clamp(gap - 1, 0.0, 1.0);
}

/// And for the farther image of a parabola, at `far` cells from the wall: it is to lie two cells before the other one.
double room_for_far(double gap, double far) {
  return std::clamp(0.5 * (gap - far), 0.0, 1.0);
}

}  // namespace

WallLayer::WallLayer(const FlowBlock& block, const CutCells& cut, const WallLayerSettings& settings)
    : block_(block), cut_(cut), sight_(cut), settings_(settings) {
  for (int c = 0; c < block.n_dimensions; ++c)
    for (int d = 0; d < 3; ++d) {
      Interval known{0, 1};
      if (d < block.n_dimensions) known = {-block.ghosts[d], block.sizes[d] + block.ghosts[d]};
      if (d < block.n_dimensions && block.decomposition->is_at_border(d, 0)) known.begin = -1;
      if (d < block.n_dimensions && block.decomposition->is_at_border(d, 1))
        known.end = block.sizes[d] + (d == c ? 0 : 1);
      known_[c].begin[d] = known.begin, known_[c].end[d] = known.end;
      Interval within = known;
      if (d < block.n_dimensions && block.decomposition->is_at_border(d, 0)) within.begin = 0;
      if (d < block.n_dimensions && block.decomposition->is_at_border(d, 1))
        within.end = block.sizes[d] - (d == c ? 1 : 0);
      within_borders_[c].begin[d] = within.begin, within_borders_[c].end[d] = within.end;
    }
  for (int c = 0; c < block.n_dimensions; ++c) {
    entry_[c] = Field<FaceEntry>(block.sizes, block.ghosts);
  }
}

void WallLayer::update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees) {
  nearest_.update(surfaces, trees);
  for (int c = 0; c < block_.n_dimensions; ++c)
    for (const std::vector<Triple>* faces : {&near_faces_[c], &image_faces_[c]})
      for (const Triple& face : *faces) entry(c, face) = {};
  for (const WallValue& ghost : ghosts_) entry(ghost.component, ghost.face) = {};
  links_.clear(), beside_.clear();
  clearness_.assign(2 * cut_.cells().size(), Clearness::unknown);
  forced_.clear(), ghosts_.clear(), ghost_side_.clear(), solid_.clear(), rows_.clear();
  sight_.update();
  collect_faces();
  add_faces_before_borders();
  for (int c = 0; c < block_.n_dimensions; ++c)
    for (const Triple& face : near_faces_[c]) find_links(c, face);
  add_pieces();
  for (int c = 0; c < block_.n_dimensions; ++c) {
    const Box mine = block_.computed_faces(c);
    for (const Triple& face : near_faces_[c]) {
      if (!mine.contains(face) || !block_.faces[c].contains(face[0], face[1], face[2])) continue;
      add_face(c, face);
      if ((entry(c, face).marks & inside_body) == 0) add_row(c, face);
    }
  }
}

/// Values that neighbours and borders fill in.
bool WallLayer::is_known(int component, const Triple& face) const {
  return known_[component].contains(face);
}

/// What a face sees of the next one along e, or of the one before.
Sight WallLayer::sight_to(int component, const Triple& face, int e, int step) const {
  Triple lower = face;
  if (step < 0) --lower[e];
  if (!is_known(component, lower) || !is_near(component, lower)) return sight_.to_neighbour(component, face, e, step);
  const FaceEntry& known = entry(component, lower);
  if ((known.marks & (1u << e)) == 0) return {};
  const Links& links = links_[static_cast<std::size_t>(known.links - 1)];
  return (step > 0 ? links.ahead : links.back)[static_cast<std::size_t>(e)];
}

int WallLayer::find_forced(int component, const Triple& face) const {
  return entry(component, face).forced - 1;
}

bool WallLayer::is_inside_body(int component, const Triple& face) const {
  return (entry(component, face).marks & inside_body) != 0;
}

void WallLayer::collect_faces() {
  for (int c = 0; c < block_.n_dimensions; ++c) near_faces_[c].clear(), image_faces_[c].clear();
  for (const CutCell& cut : cut_.cells()) {
    SurfaceSet surfaces;
    for (int w = cut.first_wall; w < cut.first_wall + cut.n_walls; ++w)
      surfaces.add(cut_.walls()[static_cast<std::size_t>(w)].surface);
    for (int c = 0; c < block_.n_dimensions; ++c) {
      Box around;
      for (int d = 0; d < 3; ++d) {
        around.begin[d] = std::max(cut.cell[d] - 1 - (d == c ? 1 : 0), known_[c].begin[d]);
        around.end[d] = std::min(cut.cell[d] + 2, known_[c].end[d]);
      }
      for (int k = around.begin[2]; k < around.end[2]; ++k)
        for (int j = around.begin[1]; j < around.end[1]; ++j) {
          FaceEntry* const row = entry_[c].row(j, k);
          for (int i = around.begin[0]; i < around.end[0]; ++i) {
            row[i].walls.surfaces.add(surfaces);
            if (row[i].marks != 0) continue;
            row[i].marks = near_wall;
            near_faces_[c].push_back({i, j, k});
          }
        }
    }
  }
}

void WallLayer::find_links(int component, const Triple& face) {
  FaceEntry& known = entry(component, face);
  if (cut_.is_face_solid(component, face)) known.marks |= inside_body;
  Triple next_cell = face;
  ++next_cell[component];
  if (cut_.find_face(component, face) < 0 && !cut_.is_solid(face) && !cut_.is_solid(next_cell))
    known.marks |= of_whole_cells;
  for (int e = 0; e < block_.n_dimensions; ++e) {
    if (sight_.is_plainly_free(component, face, e, 1)) continue;
    const Sight ahead = sight_.to_neighbour(component, face, e, 1);
    if (ahead.blocked <= 0) continue;
    known.marks |= static_cast<std::uint8_t>(1u << e);
    if (known.links == 0) {
      links_.emplace_back();
      known.links = static_cast<int>(links_.size());
    }
    Links& links = links_[static_cast<std::size_t>(known.links - 1)];
    Triple next = face;
    ++next[e];
    links.ahead[static_cast<std::size_t>(e)] = ahead;
    links.back[static_cast<std::size_t>(e)] = sight_.to_neighbour(component, next, e, -1);
  }
}

Eigen::Vector3d WallLayer::position(int component, const Triple& face) const {
  Eigen::Vector3d at;
  for (int d = 0; d < 3; ++d) at[d] = d == component ? block_.axis[d].face[face[d]] : block_.axis[d].centre[face[d]];
  return at;
}

/// Width of the cells along a direction.
double WallLayer::spacing(const Triple& cell, const Eigen::Vector3d& direction) const {
  double square = 0;
  for (int d = 0; d < block_.n_dimensions; ++d)
    square += std::pow(direction[d] / block_.axis[d].inverse_distance[cell[d]], 2);
  return std::sqrt(square);
}

double WallLayer::blend_of(const BodySurface& surface) const {
  return surface.blend_width.value_or(surface.is_closed ? settings_.blend_of_closed : settings_.blend_of_sheets);
}

void WallLayer::add_face(int component, const Triple& face) {
  const Eigen::Vector3d at = position(component, face);
  NearbyWalls& nearby = entry(component, face).walls;
  WallValue value;
  value.component = component, value.face = face;
  const bool is_solid = (entry(component, face).marks & inside_body) != 0;
  if (is_solid && nearest_.are_at_rest(nearby)) {
    solid_.push_back(value);
    return;
  }
  // In the fluid up to the blend's width in the direction in which cells are widest; a bit more for round-off.
  double widest = 0;
  for (int d = 0; d < block_.n_dimensions; ++d)
    widest = std::max(widest, (1 + 1e-9) / block_.axis[d].inverse_distance[face[d]]);
  const double reach = reach_of_ghosts * spacing(face, Eigen::Vector3d::Ones());
  const ClosestPoint closest = nearest_.that_counts(
      at, [&](const BodySurface& wall) { return is_solid ? reach : blend_of(wall) * widest; }, nearby);
  if (!closest.is_found()) return;
  const BodySurface& surface = nearest_.surface(closest.surface);
  value.wall_velocity = nearest_.velocity(closest, component);
  if (is_solid) {
    solid_.push_back(value);
    return;
  }
  const Eigen::Vector3d normal = nearest_.normal(closest);
  Eigen::Vector3d away = at - vector(closest.position);
  // Chords are not the surface itself: a face that all but touches a body may stand inside it, right behind a triangle.
  const bool is_behind = surface.is_closed && away.dot(normal) < -right_behind * closest.distance;
  bool is_outer = surface.is_closed || away.dot(normal) > 0;
  const double distance = (is_behind ? -1 : 1) * closest.distance;
  if (closest.distance > on_the_wall * spacing(face, normal))
    away /= distance;
  else
    away = is_outer ? normal : Eigen::Vector3d(-normal);
  const double width = spacing(face, away);
  const double blend = blend_of(surface);
  const double closed = 1 - nearest_.opening(closest);
  if (distance >= blend * width || closed <= 0) return;
  const double gap = gap_before(closest, away, width, widest_gap(blend), nearby, face);
  const double narrowed = std::clamp(0.5 * (gap - 1), narrowest_blend * blend, blend);
  const double share = std::clamp(1 - distance / (narrowed * width), 0.0, 1.0) * closed;
  const double beyond = std::clamp(0.5 * gap - distance / width, nearest_image, settings_.image_distance) * width;
  double seen = 0;
  // Nor are they that of a sheet: a face may stand on the side from which it looks away.
  for (const double sign : {1.0, -1.0}) {
    if (seen > hidden || (sign < 0 && distance > chord_sagitta * width)) continue;
    const double near = sign * distance + beyond;
    set_images(value, vector(closest.position), sign * away, sign * distance, near,
               room_for_far(gap, far_over_near * near / width), face);
    seen = value.image[0].seen();
    if (sign < 0 && !surface.is_closed) is_outer = !is_outer;
  }
  add_image_faces(value);
  const double room = std::min(std::clamp(2.5 * seen - 0.5, 0.0, 1.0), room_in(gap));
  if (room < 1)
    set_room(value, room, fluid_neighbours(component, face, [&](const Triple&, int e, int step) {
               return sight_to(component, face, e, step).blocked <= 0;
             }));
  forced_.push_back({value, share, closed, closest.surface, is_outer});
  entry(component, face).forced = static_cast<int>(forced_.size());
}

/// Those of a face in the fluid near walls for which `wanted` holds: it is given the neighbour, its direction and side.
template <class Wanted>
WallLayer::Neighbours WallLayer::fluid_neighbours(int component, const Triple& face, const Wanted& wanted) const {
  Neighbours neighbours;
  for (int e = 0; e < block_.n_dimensions; ++e)
    for (const int step : {-1, 1}) {
      Triple next = face;
      next[e] += step;
      if (!is_known(component, next)) continue;
      if ((entry(component, next).marks & (near_wall | inside_body)) != near_wall || !wanted(next, e, step)) continue;
      neighbours.face[static_cast<std::size_t>(neighbours.n++)] = next;
    }
  return neighbours;
}

int WallLayer::ghost(int component, const Triple& face, int surface, bool is_outer) {
  int& place = entry(component, face).last_ghost;
  for (int g = place; g > 0; g = ghost_side_[static_cast<std::size_t>(g - 1)].before) {
    const GhostSide& side = ghost_side_[static_cast<std::size_t>(g - 1)];
    if (side.surface == surface && side.is_outer == is_outer) return g - 1;
  }
  ghost_side_.push_back({surface, is_outer, place});
  place = static_cast<int>(ghost_side_.size());
  WallValue value;
  value.component = component, value.face = face;
  const Eigen::Vector3d at = position(component, face);
  const double size = spacing(face, Eigen::Vector3d::Ones());
  const ClosestPoint closest = nearest_.on(surface, at, reach_of_ghosts * size, entry(component, face).walls);
  if (closest.is_found()) {
    value.wall_velocity = nearest_.velocity(closest, component);
    const Eigen::Vector3d normal = (is_outer ? 1.0 : -1.0) * nearest_.normal(closest);
    Eigen::Vector3d towards = vector(closest.position) - at;
    // Chords are not the surface itself: a place may be found on the side from which it is seen.
    const bool is_behind = towards.dot(normal) >= 0;
    if (closest.distance > on_the_wall * spacing(face, normal))
      towards *= (is_behind ? 1 : -1) / closest.distance;
    else
      towards = normal;
    const double width = spacing(face, towards);
    const double gap = gap_before(closest, towards, width, widest_gap(0), entry(component, face).walls, face);
    const double near = std::clamp(0.5 * gap, nearest_image_of_ghost, settings_.image_distance);
    // From a neighbour that looks through the wall from that side.
    const Eigen::Vector3d image = vector(closest.position) + near * width * towards;
    const Neighbours looking = fluid_neighbours(component, face, [&](const Triple& neighbour, int e, int step) {
      const Sight sight = sight_to(component, neighbour, e, -step);
      return sight.blocked >= blocks && sight.surface == surface && sight.is_outer == is_outer;
    });
    Triple from = looking.n > 0 ? looking.face[0] : face;
    if (looking.n == 0) {
      // Seen across a corner only: from the face nearest to the image.
      for (int d = 0; d < block_.n_dimensions; ++d) {
        const AxisValues& places = d == component ? block_.axis[d].face : block_.axis[d].centre;
        while (is_known(component, from) && places[from[d] + 1] - image[d] < image[d] - places[from[d]]) ++from[d];
        while (is_known(component, from) && places[from[d]] - image[d] > image[d] - places[from[d] - 1]) --from[d];
      }
      if (!is_known(component, from)) from = face;
    }
    set_images(value, vector(closest.position), towards, (is_behind ? -1 : 1) * closest.distance, near * width,
               room_for_far(gap, far_over_near * near), from);
    add_image_faces(value);
    set_room(value, room_in(gap), looking);
  }
  ghosts_.push_back(value);
  return static_cast<int>(ghosts_.size()) - 1;
}

void WallLayer::add_row(int component, const Triple& face) {
  CutRow row;
  row.component = component, row.face = face;
  bool is_cut = false;
  Triple upper = face;
  ++upper[component];
  const auto see = [&](std::size_t entry, const Sight& sight, int seen_component, const Triple& seen_face) {
    if (sight.blocked <= 0 || sight.surface < 0) return;
    is_cut = true;
    row.seen[entry] = {sight.blocked, ghost(seen_component, seen_face, sight.surface, sight.is_outer)};
  };
  for (int e = 0; e < block_.n_dimensions; ++e)
    for (int side = 0; side < 2; ++side) {
      const int step = side == 0 ? -1 : 1;
      Triple next = face;
      next[e] += step;
      see(static_cast<std::size_t>(2 * e + side), sight_to(component, face, e, step), component, next);
    }
  for (const bool is_behind : {false, true}) {
    const Triple& cell = is_behind ? upper : face;
    if (sight_.is_one_part(cell)) continue;
    std::size_t entry = is_behind ? 8 : 6;
    for (int e = 0; e < block_.n_dimensions; ++e) {
      if (e == component) continue;
      for (int side = 0; side < 2; ++side) {
        Triple seen = cell;
        seen[e] -= side == 0 ? 1 : 0;
        see(entry + static_cast<std::size_t>(side), sight_.across_cell(cell, component, face, e, seen), e, seen);
      }
      entry += 4;
    }
  }
  if (is_cut) rows_.push_back(row);
}

}  // namespace couplet::flow
