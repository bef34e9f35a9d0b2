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

/// The height of x over the plane through the closest point of a face, across the way to y.
struct Plane {
  double height = 0;
  NodeQuad normal{};
};

/// The shares that minimise the sum: the face that gains most takes from the one that loses most, as much as is best
/// for the two, until no exchange gains.
void share_out(const std::vector<Plane>& plane, double radius, std::vector<BallTouch>& touch) {
  NodeQuad mean{};
  for (std::size_t f = 0; f < touch.size(); ++f) mean += touch[f].share * plane[f].normal;
  for (int n = 0; n < most_exchanges; ++n) {
    const auto slope = [&](std::size_t f) { return plane[f].height + radius * dot(mean, plane[f].normal); };
    std::size_t to = 0, from = touch.size();
    for (std::size_t f = 0; f < touch.size(); ++f) {
      if (slope(f) < slope(to)) to = f;
      if (touch[f].share > 0 && (from == touch.size() || slope(f) > slope(from))) from = f;
    }
    const double gain = slope(from) - slope(to);
    if (!(gain > same_gradient * radius)) return;
    const NodeQuad turn = plane[to].normal - plane[from].normal;
    const double moved = std::min(touch[from].share, gain / (radius * dot(turn, turn)));
    touch[to].share += moved;
    touch[from].share -= moved;
    mean += moved * turn;
  }
}

}  // namespace

RoundedDistance rounded_distance(std::span<const CurvedFace> faces, const NodeQuad& x, double distance,
                                 const NodeQuad& direction, double radius) {
  const double view = view_distance(distance, radius);
  const auto look_from = [&](const NodeQuad& y, std::vector<BallTouch>& touch, std::vector<Plane>& plane) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const ClosestPoint found = closest_point(faces[f], y);
      touch[f].face = f;
      touch[f].at = found.at;
      touch[f].direction = (y - found.position) / found.distance;
      plane[f] = {dot(x - found.position, touch[f].direction), touch[f].direction};
    }
  };
  std::vector<BallTouch> touch(faces.size());
  std::vector<Plane> plane(faces.size());
  touch[0].share = 1;
  NodeQuad mean = direction;
  double turned = std::numeric_limits<double>::infinity();
  for (int n = 0; n < most_steps && turned > same_middle; ++n) {
    look_from(x + view * mean, touch, plane);
    share_out(plane, radius, touch);
    NodeQuad next{};
    for (const BallTouch& t : touch) next += t.share * t.direction;
    turned = length(next - mean);
    mean = next;
  }
  // The minimum of the sum, less what its last term is for one face alone.
  RoundedDistance rounded{radius / 2 * (dot(mean, mean) - 1), mean, {}};
  for (std::size_t f = 0; f < touch.size(); ++f) rounded.distance += touch[f].share * plane[f].height;
  std::erase_if(touch, [](const BallTouch& t) { return t.share == 0; });
  rounded.touch = std::move(touch);
  return rounded;
}

}  // namespace couplet::solid
