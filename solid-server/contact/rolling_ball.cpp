#include "solid-server/contact/rolling_ball.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solid-server/contact/closest_point.hpp"

namespace couplet::solid {

namespace {

constexpr double same_middle = 1e-13;    // of the radius: y stands still
constexpr int most_steps = 200;          // faces that are flat take two, a ridge that ends in a valley the most
constexpr int most_exchanges = 1000;     // between two faces
constexpr double same_gradient = 1e-14;  // of the radius: nothing is left to exchange

/// The shares that minimise the sum: the face that gains most takes from the one that loses most, as much as is best
/// for the two, until no exchange gains.
void share_out(double radius, std::vector<BallTouch>& touch) {
  NodeQuad mean{};
  for (const BallTouch& t : touch) mean += t.share * t.direction;
  for (int n = 0; n < most_exchanges; ++n) {
    const auto slope = [&](std::size_t f) { return touch[f].height + radius * dot(mean, touch[f].direction); };
    std::size_t to = 0, from = touch.size();
    for (std::size_t f = 0; f < touch.size(); ++f) {
      if (slope(f) < slope(to)) to = f;
      if (touch[f].share > 0 && (from == touch.size() || slope(f) > slope(from))) from = f;
    }
    const double gain = slope(from) - slope(to);
    if (!(gain > same_gradient * radius)) return;
    const NodeQuad turn = touch[to].direction - touch[from].direction;
    const double moved = std::min(touch[from].share, gain / (radius * dot(turn, turn)));
    touch[to].share += moved;
    touch[from].share -= moved;
    mean += moved * turn;
  }
}

}  // namespace

RoundedDistance rounded_distance(std::span<const CurvedFace> faces, const NodeQuad& x, double distance,
                                 const NodeQuad& direction, double radius, std::vector<BallTouch> touch) {
  const double view = view_distance(distance, radius);
  const auto look_from = [&](const NodeQuad& y) {
    for (BallTouch& t : touch) {
      const ClosestPoint found = closest_point(faces[t.face], y);
      t.at = found.at;
      t.distance = found.distance;
      t.direction = (y - found.position) / found.distance;
      t.height = dot(x - found.position, t.direction);
    }
  };
  touch.assign(faces.size(), {});
  for (std::size_t f = 0; f < faces.size(); ++f) touch[f].face = f;
  touch[0].share = 1;
  NodeQuad mean = direction;
  double turned = std::numeric_limits<double>::infinity();
  for (int n = 0; n < most_steps && turned > same_middle; ++n) {
    look_from(x + view * mean);
    share_out(radius, touch);
    NodeQuad next{};
    for (const BallTouch& t : touch) next += t.share * t.direction;
    turned = length(next - mean);
    mean = next;
  }
  // The minimum of the sum, less what its last term is for one face alone.
  double rounded = radius / 2 * (dot(mean, mean) - 1), to_faces = std::numeric_limits<double>::infinity();
  for (const BallTouch& t : touch) {
    rounded += t.share * t.height;
    to_faces = std::min(to_faces, t.distance);
  }
  std::erase_if(touch, [](const BallTouch& t) { return t.share == 0; });
  return {rounded, mean, std::move(touch), to_faces};
}

}  // namespace couplet::solid
