#include "flow-server/immersed/surface_tree.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {
namespace {

constexpr std::int32_t no_child = std::numeric_limits<std::int32_t>::max();  // its box is empty
constexpr float infinite = std::numeric_limits<float>::infinity();

float round_down(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded <= value ? rounded : std::nextafter(rounded, -infinite);
}
float round_up(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded >= value ? rounded : std::nextafter(rounded, infinite);
}

/// Weights of the corners at the point of a triangle that is closest to p; those that do not count are exactly 0. By
/// the region of the plane that p lies over (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
std::array<double, 3> closest_weights(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Point bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double s = d1 / (d1 - d3);
    return {1 - s, s, 0};
  }
  const Point cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double s = d2 / (d2 - d6);
    return {1 - s, 0, s};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - s, s};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

}  // namespace

SurfaceTree::SurfaceTree(std::span<const SurfaceInTree> surfaces) {
  build(surfaces);
}

void SurfaceTree::build(std::span<const SurfaceInTree> surfaces) {
  surface_.clear(), number_.clear(), free_.clear(), node_.clear(), leaf_.clear();
  std::vector<Item> items;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const BodySurface& surface = *surfaces[s].surface;
    const auto n = static_cast<std::size_t>(surfaces[s].n_triangles);
    assert(n <= surface.triangle.size());
    const std::size_t first = surface_.size();
    std::vector<char> is_free_corner(surface.position.size(), 0);
    for (const FreeEdge& edge : surfaces[s].free_edge)
      is_free_corner[static_cast<std::size_t>(edge.from)] = is_free_corner[static_cast<std::size_t>(edge.to)] = 1;
    for (std::size_t t = 0; t < n; ++t) {
      Point middle{};
      std::uint8_t free = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(surface.triangle[t][k]);
        middle = middle + (1.0 / 3) * surface.position[corner];
        if (is_free_corner[corner]) free = static_cast<std::uint8_t>(free | (8 << k));
      }
      items.push_back({{static_cast<float>(middle[0]), static_cast<float>(middle[1]), static_cast<float>(middle[2])},
                       static_cast<std::int32_t>(surface_.size())});
      surface_.push_back(static_cast<std::int32_t>(s));
      number_.push_back(static_cast<std::int32_t>(t));
      free_.push_back(free);
    }
    for (const FreeEdge& edge : surfaces[s].free_edge) {
      if (edge.triangle >= surfaces[s].n_triangles) continue;
      const auto t = static_cast<std::size_t>(edge.triangle);
      for (std::size_t k = 0; k < 3; ++k) {
        const int from = surface.triangle[t][k], to = surface.triangle[t][(k + 1) % 3];
        if (std::minmax(from, to) == std::minmax(edge.from, edge.to))
          free_[first + t] = static_cast<std::uint8_t>(free_[first + t] | (1 << k));
      }
    }
  }
  if (!items.empty()) build_child(items, 0);
  // From here on triangles are known by their place among the boxes, so that those beside each other share cache lines.
  const auto by_place = [&items](auto& values) {
    auto placed = values;
    for (std::size_t i = 0; i < items.size(); ++i) placed[i] = values[static_cast<std::size_t>(items[i].triangle)];
    values = std::move(placed);
  };
  by_place(surface_), by_place(number_), by_place(free_);
  leaf_.resize((items.size() + n_lanes - 1) / n_lanes);
  fit(surfaces);
  built_area_ = area_of_boxes();
}

/// A node or leaf over a run of items, which are sorted so that eight by eight they are the leaves from first_leaf on.
/// All children of a node but the last are full. A tree of one leaf has a node above it all the same.
std::int32_t SurfaceTree::build_child(std::span<Item> items, std::int32_t first_leaf) {
  if (items.size() <= n_lanes && !node_.empty()) return ~first_leaf;
  const auto index = static_cast<std::int32_t>(node_.size());
  node_.emplace_back();
  node_.back().child.fill(no_child);
  std::size_t group = n_lanes;  // triangles of a child
  while (group * n_lanes < items.size()) group *= n_lanes;
  const auto cut = [&](const auto& self, std::span<Item> run) -> void {
    const std::size_t n_groups = (run.size() + group - 1) / group;
    if (n_groups < 2) return;
    std::array<float, 3> low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};
    for (const Item& item : run) {
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], item.middle[d]);
        high[d] = std::max(high[d], item.middle[d]);
      }
    }
    std::size_t widest = 0;
    for (std::size_t d = 1; d < 3; ++d)
      if (high[d] - low[d] > high[widest] - low[widest]) widest = d;
    const std::size_t left = n_groups / 2 * group;
    std::nth_element(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(left), run.end(),
                     [widest](const Item& a, const Item& b) {
                       return a.middle[widest] != b.middle[widest] ? a.middle[widest] < b.middle[widest]
                                                                   : a.triangle < b.triangle;
                     });
    self(self, run.first(left));
    self(self, run.subspan(left));
  };
  cut(cut, items);
  for (std::size_t k = 0; k * group < items.size(); ++k) {
    const auto run = items.subspan(k * group, std::min(group, items.size() - k * group));
    const std::int32_t child = build_child(run, first_leaf + static_cast<std::int32_t>(k * group / n_lanes));
    node_[static_cast<std::size_t>(index)].child[k] = child;
  }
  return index;
}

/// Copies the corners of the triangles and draws the boxes around them.
void SurfaceTree::fit(std::span<const SurfaceInTree> surfaces) {
  for (std::size_t i = 0; i < leaf_.size() * n_lanes; ++i) {
    const std::size_t place = std::min(i, number_.size() - 1);
    const BodySurface& surface = *surfaces[static_cast<std::size_t>(surface_[place])].surface;
    const auto& triangle = surface.triangle[static_cast<std::size_t>(number_[place])];
    for (std::size_t k = 0; k < 3; ++k) {
      const Point& corner = surface.position[static_cast<std::size_t>(triangle[k])];
      for (std::size_t d = 0; d < 3; ++d)
        leaf_[i / n_lanes].corner[k][d][static_cast<Eigen::Index>(i % n_lanes)] = corner[d];
    }
  }
  for (std::size_t i = node_.size(); i-- > 0;) {
    Node& node = node_[i];
    for (std::size_t k = 0; k < n_lanes; ++k) {
      const Box box = box_of(node.child[k]);
      for (std::size_t d = 0; d < 3; ++d) {
        node.low[d][static_cast<Eigen::Index>(k)] = box.low[d];
        node.high[d][static_cast<Eigen::Index>(k)] = box.high[d];
      }
    }
  }
  size_ = 0;
  if (node_.empty()) return;
  for (std::size_t d = 0; d < 3; ++d)
    size_ = std::max(size_, static_cast<double>(node_[0].high[d].maxCoeff() - node_[0].low[d].minCoeff()));
}

SurfaceTree::Box SurfaceTree::box_of(std::int32_t child) const {
  Box box{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
  if (child == no_child) return box;
  if (child < 0) return box_of_leaf(static_cast<std::size_t>(~child));
  const Node& node = node_[static_cast<std::size_t>(child)];
  for (std::size_t d = 0; d < 3; ++d) {
    box.low[d] = node.low[d].minCoeff();
    box.high[d] = node.high[d].maxCoeff();
  }
  return box;
}

SurfaceTree::Box SurfaceTree::box_of_leaf(std::size_t leaf) const {
  Box box;
  const auto& corner = leaf_[leaf].corner;
  for (std::size_t d = 0; d < 3; ++d) {
    box.low[d] = round_down(corner[0][d].min(corner[1][d]).min(corner[2][d]).minCoeff());
    box.high[d] = round_up(corner[0][d].max(corner[1][d]).max(corner[2][d]).maxCoeff());
  }
  return box;
}

double SurfaceTree::area_of_boxes() const {
  double area = 0;
  for (const Node& node : node_) {
    for (std::size_t k = 0; k < n_lanes; ++k) {
      if (node.child[k] == no_child) continue;
      std::array<double, 3> side{};
      for (std::size_t d = 0; d < 3; ++d)
        side[d] =
            static_cast<double>(node.high[d][static_cast<Eigen::Index>(k)] - node.low[d][static_cast<Eigen::Index>(k)]);
      area += side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
    }
  }
  return area;
}

void SurfaceTree::refit(std::span<const SurfaceInTree> surfaces) {
  fit(surfaces);
  // What a query visits grows with the area of the boxes; a new tree costs several times a fit.
  if (area_of_boxes() > 2 * built_area_) build(surfaces);
}

void SurfaceTree::compare(std::int32_t place, const Point& point, double& nearest, ClosestPoint& found) const {
  const auto i = static_cast<std::size_t>(place);
  const Leaf& leaf = leaf_[i / n_lanes];
  const auto lane = static_cast<Eigen::Index>(i % n_lanes);
  const auto corner = [&](std::size_t k) {
    return Point{leaf.corner[k][0][lane], leaf.corner[k][1][lane], leaf.corner[k][2][lane]};
  };
  const Point a = corner(0), b = corner(1), c = corner(2);
  const std::array<double, 3> weight = closest_weights(point, a, b, c);
  const Point position = weight[0] * a + weight[1] * b + weight[2] * c;
  const Point away = point - position;
  const double squared = dot(away, away);
  const double tie = farthest_tie(nearest) - nearest;
  const bool is_first =
      !found.is_found() || surface_[i] < found.surface || (surface_[i] == found.surface && number_[i] < found.triangle);
  if (found.is_found() ? squared < nearest - tie || (squared <= nearest + tie && is_first) : squared <= nearest) {
    nearest = found.is_found() ? std::min(nearest, squared) : squared;
    found.surface = surface_[i];
    found.triangle = number_[i];
    found.weight = weight;
    found.position = position;
    found.hint = place;
  }
}

/// Squared distances of all eight triangles at once, without branches; then those that may be nearest one by one.
void SurfaceTree::compare_leaf(std::int32_t leaf, const Point& point, double& nearest, ClosestPoint& found) const {
  const auto& corner = leaf_[static_cast<std::size_t>(leaf)].corner;
  std::array<std::array<Doubles, 3>, 3> from, side;  // from each corner to the point; from each corner to the next
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      from[k][d] = point[d] - corner[k][d];
      side[k][d] = corner[(k + 1) % 3][d] - corner[k][d];
    }
  }
  const auto dot_of = [](const std::array<Doubles, 3>& a, const std::array<Doubles, 3>& b) -> Doubles {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  const auto cross_of = [](const std::array<Doubles, 3>& a, const std::array<Doubles, 3>& b) {
    return std::array<Doubles, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const std::array<Doubles, 3> normal = cross_of(side[0], side[1]);  // twice the area long
  Doubles squared = Doubles::Constant(std::numeric_limits<double>::infinity());
  Doubles inwards = squared;  // the least of (n x side) . from: negative outside of a side
  for (std::size_t k = 0; k < 3; ++k) {
    const Doubles share = (dot_of(from[k], side[k]) / dot_of(side[k], side[k])).max(0.0).min(1.0);
    std::array<Doubles, 3> away;
    for (std::size_t d = 0; d < 3; ++d) away[d] = from[k][d] - share * side[k][d];
    squared = squared.min(dot_of(away, away));
    inwards = inwards.min(dot_of(cross_of(normal, side[k]), from[k]));
  }
  const Doubles height = dot_of(normal, from[0]);
  squared = (inwards >= 0).select(height * height / dot_of(normal, normal), squared);
  const double limit = farthest_tie(std::min(nearest, squared.minCoeff()));
  for (Eigen::Index lane = 0; lane < n_lanes; ++lane) {
    if (!(squared[lane] <= limit)) continue;
    const std::int32_t place = n_lanes * leaf + static_cast<std::int32_t>(lane);
    if (place < n_triangles() && place != found.hint) compare(place, point, nearest, found);
  }
}

ClosestPoint SurfaceTree::closest(const Point& point, double largest_distance, int hint) const {
  ClosestPoint found;
  if (node_.empty()) return found;
  double nearest = largest_distance * largest_distance;
  if (hint >= 0 && hint < n_triangles()) compare(hint, point, nearest, found);

  struct Open {
    float squared;
    std::int32_t child;
  };
  // A node leaves at most eight others waiting on each of its levels; eight to the 10th is more than 2^29 triangles.
  std::array<Open, n_lanes * 12> open;
  std::size_t n_open = 0;
  open[n_open++] = {0, 0};
  std::array<float, 3> low{}, high{};
  for (std::size_t d = 0; d < 3; ++d) low[d] = round_down(point[d]), high[d] = round_up(point[d]);
  while (n_open > 0) {
    const Open here = open[--n_open];
    if (static_cast<double>(here.squared) > farthest_tie(nearest)) continue;
    if (here.child < 0) {
      compare_leaf(~here.child, point, nearest, found);
      continue;
    }
    const Node& node = node_[static_cast<std::size_t>(here.child)];
    Singles squared = Singles::Zero();
    for (std::size_t d = 0; d < 3; ++d) {
      const Singles outside = (node.low[d] - high[d]).max(low[d] - node.high[d]).max(0.0f);
      squared += outside * outside;
    }
    squared *= 1 - 1e-6f;  // never above the true one: five roundings of 6e-8
    const auto limit = static_cast<float>(farthest_tie(nearest) * (1 + 1e-6));
    const std::size_t first_open = n_open;
    for (std::size_t k = 0; k < n_lanes; ++k) {
      const float away = squared[static_cast<Eigen::Index>(k)];
      if (!(away <= limit) || node.child[k] == no_child) continue;
      // The farthest first, so that the nearest is taken next.
      std::size_t at = n_open++;
      for (; at > first_open && open[at - 1].squared < away; --at) open[at] = open[at - 1];
      open[at] = {away, node.child[k]};
    }
  }
  if (!found.is_found()) return found;
  found.distance = distance(point, found.position);
  const auto free = free_[static_cast<std::size_t>(found.hint)];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const bool on_side = found.weight[last] == 0 && found.weight[k] > 0 && found.weight[next] > 0;
    const bool on_corner = found.weight[next] == 0 && found.weight[last] == 0;
    if ((on_side && (free >> k & 1)) || (on_corner && (free >> (3 + k) & 1))) found.is_on_free_edge = true;
  }
  return found;
}

}  // namespace couplet::flow
