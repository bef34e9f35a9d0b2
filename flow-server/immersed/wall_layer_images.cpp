// Where the images of wall values are interpolated from.

#include <algorithm>
#include <cmath>

#include "flow-server/immersed/wall_layer.hpp"

namespace couplet::flow {

namespace {

/// Weights that sum to this are all of them.
constexpr double nearly_all = 0.95;
/// Where less of an image is seen no parabola is drawn through it.
constexpr double least_share_seen = 0.75;

}  // namespace

/// How well a face sees the next one along e: 1 wholly, 0 not at all. `lower`: the one of both where the link starts.
double WallLayer::openness(const FaceEntry& lower, const FaceEntry& next, int e) const {
  if ((next.marks & inside_body) != 0) return 0;
  if ((lower.marks & (1u << e)) == 0) return 1;
  return 1 - links_[static_cast<std::size_t>(lower.links - 1)].ahead[static_cast<std::size_t>(e)].blocked;
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
    if (image.seen() > nearly_all) break;
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
  if (value.image[0].seen() <= least_share_seen || room_for_far <= 0) return;
  constexpr double b = far_over_near;
  WallImage far = image_at(value.component, wall + b * near * away, from);
  const double trust = (std::min(far.seen(), value.image[0].seen()) - least_share_seen) / (1 - least_share_seen);
  if (trust <= 0) return;
  // Lagrange's parabola through 0, 1 and b.
  const double s = distance / near, parabola = s * (b - s) / (b - 1);
  const double share = std::min(trust, 1.0) * room_for_far;
  value.image[0].ratio += share * (parabola - s);
  far.ratio = share * s * (s - 1) / (b * (b - 1));
  value.image[1] = far;
}

/// Of the first image, whose slope counts.
void WallLayer::add_image_faces(const WallValue& value) {
  const WallImage& image = value.image[0];
  for (std::size_t n = 0; n < 8; ++n) {
    if (image.weight[n] == 0) continue;
    const Triple face{image.base[0] + static_cast<int>(n & 1u), image.base[1] + static_cast<int>((n >> 1) & 1u),
                      image.base[2] + static_cast<int>((n >> 2) & 1u)};
    add_image_face(value.component, face);
  }
}

void WallLayer::add_image_face(int component, const Triple& face) {
  std::uint8_t& marks = entry(component, face).marks;
  if ((marks & (near_wall | for_images)) != 0) return;
  marks |= for_images;
  image_faces_[component].push_back(face);
}

/// A ghost beyond a border follows from two faces before it.
void WallLayer::add_faces_before_borders() {
  for (int c = 0; c < block_.n_dimensions; ++c)
    for (const Triple& face : near_faces_[c])
      for (int d = 0; d < block_.n_dimensions; ++d) {
        const bool is_before = face[d] < within_borders_[c].begin[d];
        if (d == c || (!is_before && face[d] < within_borders_[c].end[d])) continue;
        if (!block_.decomposition->is_at_border(d, is_before ? 0 : 1)) continue;
        for (const int n : {1, 2}) {
          Triple inner = face;
          inner[d] += is_before ? n : -n;
          add_image_face(c, inner);
        }
      }
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
  Box between, base;
  for (int d = 0; d < 3; ++d) {
    const int reach = d < block_.n_dimensions ? 1 : 0;
    base.begin[d] = image.base[d], base.end[d] = image.base[d] + reach + 1;
    between.begin[d] = std::min(from[d], base.begin[d]) - reach * detour;
    between.end[d] = std::max(from[d] + 1, base.end[d]) + reach * detour;
  }
  if (is_all_free(c, between)) {
    weigh(image, place, [](const Triple&) { return 1.0; });
    return;
  }
  constexpr int most_places = 512;
  if (between.n_cells() > most_places) return;  // weights 0: the wall's velocity
  std::array<double, most_places> seen;         // along the way on which it is seen best
  std::fill_n(seen.begin(), between.n_cells(), 0.0);
  const std::array<int, 3> next_seen{1, between.size(0), between.size(0) * between.size(1)};
  const std::array<std::ptrdiff_t, 3> next_entry{1, entry_[c].stride_y(), entry_[c].stride_z()};
  const auto index = [&](const Triple& face) {
    int n = 0;
    for (int d = 0; d < 3; ++d) n += next_seen[static_cast<std::size_t>(d)] * (face[d] - between.begin[d]);
    return static_cast<std::size_t>(n);
  };
  // Those that lead to the image are gone last and so, from the top of a stack, on from first.
  struct Way {
    int direction, step;
  };
  std::array<Way, 6> ways;
  for (int e = 0; e < block_.n_dimensions; ++e) {
    const int towards = image.base[e] >= from[e] ? 1 : -1;
    ways[static_cast<std::size_t>(e)] = {e, -towards};
    ways[static_cast<std::size_t>(block_.n_dimensions + e)] = {e, towards};
  }
  std::array<Triple, most_places> waiting;
  int n_waiting = 0;
  waiting[static_cast<std::size_t>(n_waiting++)] = from;
  seen[index(from)] = 1;
  int n_hidden = static_cast<int>(base.n_cells()) - (base.contains(from) ? 1 : 0);  // not wholly seen so far
  while (n_waiting > 0 && n_hidden > 0) {
    const Triple now = waiting[static_cast<std::size_t>(--n_waiting)];
    if (is_beyond_border(c, now)) continue;  // no surface is seen there: ways do not lead through it
    double* const seen_now = &seen[index(now)];
    const FaceEntry* const entry_now = &entry(c, now);
    for (int w = 0; w < 2 * block_.n_dimensions; ++w) {
      const auto [e, step] = ways[static_cast<std::size_t>(w)];
      Triple next = now;
      next[e] += step;
      if (next[e] < between.begin[e] || next[e] >= between.end[e]) continue;
      double& seen_next = seen_now[step * next_seen[static_cast<std::size_t>(e)]];
      if (seen_next >= *seen_now || !is_known(c, next)) continue;
      const FaceEntry& entry_next = entry_now[step * next_entry[static_cast<std::size_t>(e)]];
      const double through = std::min(*seen_now, openness(step > 0 ? *entry_now : entry_next, entry_next, e));
      if (through <= seen_next || n_waiting == most_places) continue;
      seen_next = through;
      waiting[static_cast<std::size_t>(n_waiting++)] = next;
      if (through == 1 && base.contains(next)) --n_hidden;
    }
  }
  weigh(image, place, [&](const Triple& face) { return seen[index(face)]; });
}

/// Whether no wall stands anywhere among these faces, nor a border.
bool WallLayer::is_all_free(int component, const Box& faces) const {
  const Box& within = within_borders_[component];
  for (int d = 0; d < 3; ++d)
    if (faces.begin[d] < within.begin[d] || faces.end[d] > within.end[d]) return false;
  std::uint8_t marks = 0;
  for (int k = faces.begin[2]; k < faces.end[2]; ++k)
    for (int j = faces.begin[1]; j < faces.end[1]; ++j) {
      const FaceEntry* const row = entry_[component].row(j, k);
      for (int i = faces.begin[0]; i < faces.end[0]; ++i) marks |= row[i].marks;
    }
  return (marks & static_cast<std::uint8_t>(~free_marks)) == 0;
}

template <class Seen>
void WallLayer::weigh(WallImage& image, const Eigen::Vector3d& place, const Seen& seen) const {
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
    image.weight[n] = weight > 0 ? weight * seen(face) : 0;
  }
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
