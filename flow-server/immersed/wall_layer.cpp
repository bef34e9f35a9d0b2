#include "flow-server/immersed/wall_layer.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace couplet::flow {

namespace {

constexpr std::uint8_t inside_body = 8, near_wall = 16;
/// Nearer to the wall than this share of a cell its normal is the direction away from it.
constexpr double on_the_wall = 1e-3;
/// Faces within so many cells of the surface that blocks a sight are those that are seen through it.
constexpr double reach_of_ghosts = 3;
/// Surfaces stand off the chords between crossings by less than this share of a cell where they are resolved.
constexpr double chord_sagitta = 0.2;
/// Weights that sum to this are all of them, or none to speak of.
constexpr double nearly_all = 0.95, hidden = 0.2;
/// Where less of an image is seen no parabola is drawn through it.
constexpr double least_seen = 0.75;
/// Distances of the images from the wall: a cell apart. Farther ones would need more layers of neighbours' cells.
constexpr double far_over_near = 5.0 / 3;
/// In gaps the blend shrinks, so that at least one cell of it is left to the equations, to this share of itself; and
/// images stand in the middle, no nearer to the place they are for, or to the wall of a ghost, than this [cells].
constexpr double narrowest_blend = 0.25, nearest_image = 0.5, nearest_image_of_ghost = 0.75;
/// Blocked by more than this a link is none for interpolation.
constexpr double blocks = 0.5;

/// What gaps of some cells' width leave room for: an image on either side from 2 cells on, none below 1.
double room_in(double gap) {
  return std::clamp(gap - 1, 0.0, 1.0);
}

/// And for the farther image of a parabola, which is to lie two cells before the other wall; `near` likewise in cells.
double room_for_far(double gap, double near) {
  return std::clamp(0.5 * (gap - far_over_near * near), 0.0, 1.0);
}

double seen_of(const WallImage& image) {
  return std::accumulate(image.weight.begin(), image.weight.end(), 0.0);
}

}  // namespace

std::size_t WallLayer::KeyHash::operator()(const Key& key) const {
  std::uint64_t mixed = static_cast<std::uint64_t>(key.component);
  for (const int number : {key.face[0], key.face[1], key.face[2], key.direction})
    mixed = (mixed ^ static_cast<std::uint64_t>(static_cast<std::uint32_t>(number))) * 0x9E3779B97F4A7C15ull;
  return static_cast<std::size_t>(mixed ^ (mixed >> 32));
}

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
    }
  for (int c = 0; c < block.n_dimensions; ++c) {
    entry_[c] = Field<FaceEntry>(block.sizes, block.ghosts);
  }
}

void WallLayer::update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees) {
  surfaces_ = surfaces;
  for (int c = 0; c < block_.n_dimensions; ++c)
    for (const Triple& face : near_faces_[c]) entry(c, face) = {};
  for (const WallValue& ghost : ghosts_) entry(ghost.component, ghost.face) = {};
  half_open_.clear();
  forced_.clear(), ghosts_.clear(), ghost_side_.clear(), solid_.clear(), rows_.clear();
  nearest_.update(surfaces, trees);
  sight_.update();
  collect_faces();
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

void WallLayer::add_pieces() {
  ghost_of_piece_.assign(cut_.pieces().size(), -1);
  shifts_.clear();
  for (const CutFace& face : cut_.faces()) {
    // Faces of own cells; on a border with a given velocity all pieces have that.
    Box wanted = box_of(block_.sizes);
    --wanted.begin[face.direction];
    if (face.n_pieces == 1 || !wanted.contains(face.face) ||
        !block_.faces[face.direction].contains(face.face[0], face.face[1], face.face[2]))
      continue;
    for (int p = face.first_piece; p < face.first_piece + face.n_pieces; ++p) {
      const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
      const int part = piece.lower_part >= 0 ? piece.lower_part : piece.upper_part;
      if (!cut_.parts()[static_cast<std::size_t>(part)].is_fluid) continue;
      if (p != face.centre_piece && piece.surface >= 0)
        ghost_of_piece_[static_cast<std::size_t>(p)] = ghost(face.direction, face.face, piece.surface, piece.is_outer);
      add_shift(face, p);
    }
  }
}

void WallLayer::add_shift(const CutFace& face, int p) {
  const FacePiece& piece = cut_.pieces()[static_cast<std::size_t>(p)];
  const int d = face.direction;
  PieceShift shift{.piece = p,
                   .component = d,
                   .face = face.face,
                   .ghost = ghost_of_piece_[static_cast<std::size_t>(p)],
                   .n_neighbours = 0,
                   .neighbour = {}};
  for (int t = 0; t < 2; ++t) {
    const int e = (d + 1 + t) % 3;
    const double offset = piece.offset[static_cast<std::size_t>(t)];
    if (e >= block_.n_dimensions || offset == 0) continue;
    const int step = offset > 0 ? 1 : -1;
    Triple next = face.face;
    next[e] += step;
    if (!is_known(d, next) || !sight_.sees_neighbour(piece, d, face.face, e, step)) continue;
    const double over = block_.axis[e].inverse_distance[std::min(face.face[e], next[e])];
    const auto n = static_cast<std::size_t>(shift.n_neighbours++);
    shift.neighbour[n] = next;
    shift.weight[n] = std::abs(offset) * over;
  }
  if (shift.n_neighbours > 0) shifts_.push_back(shift);
}

/// Values that neighbours and borders fill in.
bool WallLayer::is_known(int component, const Triple& face) const {
  return known_[component].contains(face);
}

/// Whether a face sees the next one along e, or the one before, as links that were found and cells say; with false
/// it may all the same.
bool WallLayer::is_free(int component, const Triple& face, int e, int step) const {
  Triple next = face;
  next[e] += step;
  const Triple& lower = step < 0 ? next : face;
  if (is_known(component, lower) && is_near(component, lower)) return (entry(component, lower).marks & (1u << e)) == 0;
  return false;
}

int WallLayer::find_forced(int component, const Triple& face) const {
  return entry(component, face).forced - 1;
}

bool WallLayer::is_inside_body(int component, const Triple& face) const {
  return (entry(component, face).marks & inside_body) != 0;
}

void WallLayer::collect_faces() {
  for (int c = 0; c < block_.n_dimensions; ++c) near_faces_[c].clear();
  for (const CutCell& cut : cut_.cells())
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
            if (row[i].marks != 0) continue;
            row[i].marks = near_wall;
            near_faces_[c].push_back({i, j, k});
          }
        }
    }
}

void WallLayer::find_links(int component, const Triple& face) {
  std::uint8_t& mark = entry(component, face).marks;
  if (cut_.is_face_solid(component, face)) mark |= inside_body;
  for (int e = 0; e < block_.n_dimensions; ++e) {
    if (sight_.is_plainly_free(component, face, e, 1)) continue;
    const double blocked = sight_.to_neighbour(component, face, e, 1).blocked;
    if (blocked <= 0) continue;
    mark |= static_cast<std::uint8_t>(1u << e);
    if (blocked < 1) half_open_[{component, face, e}] = 1 - blocked;
  }
}

/// How well a face sees the next one along e: 1 wholly, 0 not at all.
double WallLayer::openness(int component, const Triple& face, int e, int step) const {
  Triple lower = face, next = face;
  next[e] += step;
  if (step < 0) lower = next;
  if ((entry(component, next).marks & inside_body) != 0) return 0;
  if ((entry(component, lower).marks & (1u << e)) == 0) return 1;
  const auto found = half_open_.find({component, lower, e});
  return found == half_open_.end() ? 0 : found->second;
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

/// Weights of the faces around a point that `from` can reach by links among the faces between both.
WallImage WallLayer::image_at(int c, const Eigen::Vector3d& point, const Triple& from) const {
  WallImage image;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  image.base = from;
  for (int d = 0; d < block_.n_dimensions; ++d) {
    const AxisValues& at = d == c ? block_.axis[d].face : block_.axis[d].centre;
    int i = from[d];
    const int least = -axis_margin, most = block_.sizes[d] + axis_margin - 2;
    while (i > least && at[i] > point[d]) --i;
    while (i < most && at[i + 1] <= point[d]) ++i;
    image.base[d] = i;
    place[d] = std::clamp((point[d] - at[i]) / (at[i + 1] - at[i]), 0.0, 1.0);
  }
  // First along the shortest ways; where these are barred, by a corner of the wall for example, by ways around too.
  for (const int detour : {0, 1}) {
    weigh_seen_faces(c, image, place, from, detour);
    if (seen_of(image) > nearly_all) break;
  }
  return image;
}

/// The images of a value at `distance` from the nearest point of a wall along `away`, negative behind it; the first one
/// at the distance `near`. `room_for_far`: 0 where a straight line is to do without the second one.
void WallLayer::set_images(WallValue& value, const Eigen::Vector3d& wall, const Eigen::Vector3d& away, double distance,
                           double near, double room_for_far, const Triple& from) const {
  value.image[0] = image_at(value.component, wall + near * away, from);
  value.image[0].ratio = distance / near;
  value.image[1] = {};
  if (seen_of(value.image[0]) <= least_seen || room_for_far <= 0) return;
  constexpr double b = far_over_near;
  WallImage far = image_at(value.component, wall + b * near * away, from);
  const double trust = (std::min(seen_of(far), seen_of(value.image[0])) - least_seen) / (1 - least_seen);
  if (trust <= 0) return;
  // Lagrange's parabola through 0, 1 and b.
  const double s = distance / near, parabola = s * (b - s) / (b - 1);
  const double share = std::min(trust, 1.0) * room_for_far;
  value.image[0].ratio += share * (parabola - s);
  far.ratio = share * s * (s - 1) / (b * (b - 1));
  value.image[1] = far;
}

/// Beyond a border of the grid, or on it.
bool WallLayer::is_beyond_border(int component, const Triple& face) const {
  for (int d = 0; d < block_.n_dimensions; ++d) {
    const int last = block_.sizes[d] - (d == component ? 1 : 0);
    if (face[d] < 0 && block_.decomposition->is_at_border(d, 0)) return true;
    if (face[d] >= last && block_.decomposition->is_at_border(d, 1)) return true;
  }
  return false;
}

/// Weights of trilinear interpolation at `place` between the faces from image.base on, as far as `from` sees them
/// through links among the faces between both and `detour` layers around.
void WallLayer::weigh_seen_faces(int c, WallImage& image, const Eigen::Vector3d& place, const Triple& from,
                                 int detour) const {
  Triple low, size;
  for (int d = 0; d < 3; ++d) {
    const int reach = d < block_.n_dimensions ? 1 : 0;
    low[d] = std::min(from[d], image.base[d]) - reach * detour;
    size[d] = std::max(from[d], image.base[d] + reach) + reach * detour - low[d] + 1;
  }
  constexpr int most_places = 512;
  if (size[0] * size[1] * size[2] > most_places) return;  // weights 0: the wall's velocity
  std::array<double, most_places> seen;                   // along the way on which it is seen best
  std::fill_n(seen.begin(), size[0] * size[1] * size[2], 0.0);
  std::array<Triple, most_places> waiting;
  int n_waiting = 0;
  const auto index = [&](const Triple& face) {
    return static_cast<std::size_t>((face[0] - low[0]) + size[0] * ((face[1] - low[1]) + size[1] * (face[2] - low[2])));
  };
  waiting[static_cast<std::size_t>(n_waiting++)] = from;
  seen[index(from)] = 1;
  while (n_waiting > 0) {
    const Triple now = waiting[static_cast<std::size_t>(--n_waiting)];
    if (is_beyond_border(c, now)) continue;  // no surface is seen there: ways do not lead through it
    for (int e = 0; e < block_.n_dimensions; ++e)
      for (const int step : {-1, 1}) {
        Triple next = now;
        next[e] += step;
        if (next[e] < low[e] || next[e] >= low[e] + size[e] || seen[index(next)] >= seen[index(now)] ||
            !is_known(c, next))
          continue;
        const double through = std::min(seen[index(now)], openness(c, now, e, step));
        if (through <= seen[index(next)] || n_waiting == most_places) continue;
        seen[index(next)] = through;
        waiting[static_cast<std::size_t>(n_waiting++)] = next;
      }
  }
  for (std::size_t n = 0; n < 8; ++n) {
    Triple face = image.base;
    double weight = 1;
    for (int d = 0; d < 3; ++d) {
      const bool is_high = ((n >> d) & 1u) != 0;
      if (is_high && d >= block_.n_dimensions) weight = 0;
      if (d >= block_.n_dimensions) continue;
      face[d] += is_high ? 1 : 0;
      weight *= is_high ? place[d] : 1 - place[d];
    }
    image.weight[n] = weight > 0 ? weight * seen[index(face)] : 0;
  }
}

void WallLayer::add_face(int component, const Triple& face) {
  const Eigen::Vector3d at = position(component, face);
  const bool is_solid = (entry(component, face).marks & inside_body) != 0;
  // In the fluid up to the blend's width in the direction in which cells are widest; a bit more for round-off.
  double widest = 0;
  for (int d = 0; d < block_.n_dimensions; ++d)
    widest = std::max(widest, (1 + 1e-9) / block_.axis[d].inverse_distance[face[d]]);
  const ClosestPoint closest =
      is_solid ? nearest_.of_all(at, reach_of_ghosts * spacing(face, Eigen::Vector3d::Ones()))
               : nearest_.that_counts(at, settings_.blend_of_closed * widest, settings_.blend_of_sheets * widest);
  if (!closest.is_found()) return;
  const BodySurface& surface = surfaces_[static_cast<std::size_t>(closest.surface)];
  WallValue value;
  value.component = component, value.face = face;
  value.wall_velocity = velocity_at(surface, closest, component);
  if (is_solid) {
    solid_.push_back(value);
    return;
  }
  const Eigen::Vector3d normal = unit_normal(surface, closest.triangle);
  Eigen::Vector3d away = at - to_vector(closest.position);
  bool is_outer = surface.is_closed || away.dot(normal) > 0;
  const double distance = closest.distance;
  if (distance > on_the_wall * spacing(face, normal))
    away /= distance;
  else
    away = is_outer ? normal : Eigen::Vector3d(-normal);
  const double width = spacing(face, away);
  const double blend = surface.is_closed ? settings_.blend_of_closed : settings_.blend_of_sheets;
  const double closed = 1 - opening_at(surface, closest);
  if (distance >= blend * width || closed <= 0) return;
  // Wider gaps than these change nothing of what follows.
  const double most = 2 * (blend + settings_.image_distance) + 1.5;
  const double gap = nearest_.gap(to_vector(closest.position), away, most * width) / width;
  const double narrowed = std::clamp(0.5 * (gap - 1), narrowest_blend * blend, blend);
  const double share = std::max(1 - distance / (narrowed * width), 0.0) * closed;
  const double beyond = std::clamp(0.5 * gap - distance / width, nearest_image, settings_.image_distance) * width;
  double seen = 0;
  // Chords are not the surface itself: a face that all but touches it may stand on the side from which it looks away.
  for (const double sign : {1.0, -1.0}) {
    if (seen > hidden || (sign < 0 && distance > chord_sagitta * width)) continue;
    const double near = sign * distance + beyond;
    set_images(value, to_vector(closest.position), sign * away, sign * distance, near, room_for_far(gap, near / width),
               face);
    seen = seen_of(value.image[0]);
    if (sign < 0 && !surface.is_closed) is_outer = !is_outer;
  }
  value.room = std::min(std::clamp(2.5 * seen - 0.5, 0.0, 1.0), room_in(gap));
  forced_.push_back({value, share, closed, closest.surface, is_outer});
  entry(component, face).forced = static_cast<int>(forced_.size());
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
  const ClosestPoint closest = nearest_.on(surface, at, reach_of_ghosts * size);
  if (closest.is_found()) {
    const BodySurface& wall = surfaces_[static_cast<std::size_t>(closest.surface)];
    value.wall_velocity = velocity_at(wall, closest, component);
    const Eigen::Vector3d normal = (is_outer ? 1.0 : -1.0) * unit_normal(wall, closest.triangle);
    Eigen::Vector3d towards = to_vector(closest.position) - at;
    // Chords are not the surface itself: a place may be found on the side from which it is seen.
    const bool is_behind = towards.dot(normal) >= 0;
    if (closest.distance > on_the_wall * spacing(face, normal))
      towards *= (is_behind ? 1 : -1) / closest.distance;
    else
      towards = normal;
    const double width = spacing(face, towards);
    const double most = far_over_near * settings_.image_distance + 2;
    const double gap = nearest_.gap(to_vector(closest.position), towards, most * width) / width;
    const double near = std::clamp(0.5 * gap, nearest_image_of_ghost, settings_.image_distance);
    const double beyond = near * width;
    value.room = room_in(gap);
    // From a neighbour that looks through the wall from that side.
    const Eigen::Vector3d image = to_vector(closest.position) + beyond * towards;
    Triple from = face;
    bool has_from = false;
    for (int e = 0; e < block_.n_dimensions && !has_from; ++e)
      for (const int step : {-1, 1}) {
        Triple neighbour = face;
        neighbour[e] += step;
        if (has_from || !is_known(component, neighbour) || (entry(component, neighbour).marks & inside_body) != 0 ||
            is_free(component, face, e, step))
          continue;
        const Sight sight = sight_.to_neighbour(component, neighbour, e, -step);
        if (sight.blocked < blocks || sight.surface != surface || sight.is_outer != is_outer) continue;
        from = neighbour, has_from = true;
      }
    if (!has_from) {
      // Seen across a corner only: from the face nearest to the image.
      for (int d = 0; d < block_.n_dimensions; ++d) {
        const AxisValues& places = d == component ? block_.axis[d].face : block_.axis[d].centre;
        while (is_known(component, from) && places[from[d] + 1] - image[d] < image[d] - places[from[d]]) ++from[d];
        while (is_known(component, from) && places[from[d]] - image[d] > image[d] - places[from[d] - 1]) --from[d];
      }
      if (!is_known(component, from)) from = face;
    }
    set_images(value, to_vector(closest.position), towards, (is_behind ? -1 : 1) * closest.distance, beyond,
               room_for_far(gap, near), from);
  }
  ghosts_.push_back(value);
  return static_cast<int>(ghosts_.size()) - 1;
}

std::vector<Triple> WallLayer::seen_from(int ghost) const {
  const WallValue& value = ghosts_[static_cast<std::size_t>(ghost)];
  const GhostSide& side = ghost_side_[static_cast<std::size_t>(ghost)];
  std::vector<Triple> seen;
  for (int e = 0; e < block_.n_dimensions; ++e)
    for (const int step : {-1, 1}) {
      Triple next = value.face;
      next[e] += step;
      if (!is_known(value.component, next) || !is_near(value.component, next) ||
          is_inside_body(value.component, next) || is_free(value.component, value.face, e, step))
        continue;
      const Sight sight = sight_.to_neighbour(value.component, next, e, -step);
      if (sight.blocked >= blocks && sight.surface == side.surface && sight.is_outer == side.is_outer)
        seen.push_back(next);
    }
  return seen;
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
      if (is_free(component, face, e, step)) continue;
      Triple next = face;
      next[e] += step;
      see(static_cast<std::size_t>(2 * e + side), sight_.to_neighbour(component, face, e, step), component, next);
    }
  std::size_t entry = 6;
  for (int e = 0; e < block_.n_dimensions; ++e) {
    if (e == component) continue;
    for (const Triple& cell : {face, upper})
      for (int side = 0; side < 2; ++side, ++entry) {
        if (cut_.find(cell) < 0) continue;
        Triple seen = cell;
        seen[e] -= side == 0 ? 1 : 0;
        see(entry, sight_.across_cell(cell, component, face, e, seen), e, seen);
      }
  }
  if (is_cut) rows_.push_back(row);
}

double WallLayer::value_of(const WallValue& value, const Field<double>& velocity) {
  double result = value.wall_velocity;
  for (const WallImage& image : value.image)
    if (image.ratio != 0) result += image.ratio * rise_to(image, value.wall_velocity, velocity);
  return result;
}

double WallLayer::rise_to(const WallImage& image, double wall_velocity, const Field<double>& velocity) {
  double rise = 0;
  for (std::size_t n = 0; n < 8; ++n)
    if (image.weight[n] != 0)
      rise += image.weight[n] *
              (velocity(image.base[0] + static_cast<int>(n & 1u), image.base[1] + static_cast<int>((n >> 1) & 1u),
                        image.base[2] + static_cast<int>((n >> 2) & 1u)) -
               wall_velocity);
  return rise;
}

}  // namespace couplet::flow
