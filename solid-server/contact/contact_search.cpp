#include "solid-server/contact/contact_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solid-server/contact/closest_point.hpp"

namespace couplet::solid {

namespace {

constexpr Index faces_per_leaf = 4;

// The largest sum of |N_a| on a face (eight nodes, in the middle): when no node moves by more than 1, no point of the
// face moves by more than this.
constexpr double largest_shape_sum = 3;

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

Box around(const Box& a, const Box& b) {
  return {a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

/// Distance between two boxes, 0 when they overlap.
double distance(const Box& a, const Box& b) {
  const NodeQuad below = a.low - b.high, above = b.low - a.high;
  NodeQuad apart = below > above ? below : above;
  apart = apart > 0.0 ? apart : NodeQuad{};
  return length(apart);
}

/// Mean motion of the nodes of a region, and how far a node is from it at most.
struct Motion {
  NodeQuad mean{};
  double deviation = 0;
};

Motion motion_of(const ContactRegion& region, const ContactPositions& from, const ContactPositions& to) {
  Motion motion;
  for (const Index n : region.node) motion.mean += to[at(n)] - from[at(n)];
  motion.mean /= static_cast<double>(region.node.size());
  double squared = 0;
  for (const Index n : region.node) {
    const NodeQuad away = to[at(n)] - from[at(n)] - motion.mean;
    squared = std::max(squared, dot(away, away));
  }
  motion.deviation = std::sqrt(squared);
  return motion;
}

/// Of all nodes, on their way between two sets of positions.
Box swept_box(const ContactRegion& region, const ContactPositions& from, const ContactPositions& to) {
  Box box{from[at(region.node.front())], from[at(region.node.front())]};
  for (const Index n : region.node) box = around(around(box, {from[at(n)], from[at(n)]}), {to[at(n)], to[at(n)]});
  return box;
}

}  // namespace

double largest_approach(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& from,
                        const ContactPositions& to, double reach) {
  if (distance(swept_box(points, from, to), swept_box(faces, from, to)) > reach) return 0;
  const Motion of_points = motion_of(points, from, to), of_faces = motion_of(faces, from, to);
  return length(of_points.mean - of_faces.mean) + of_points.deviation + of_faces.deviation;
}

ContactSearch::ContactSearch(const ContactRegion& faces, const ContactPositions& rest, const SearchReach& reach)
    : reach_(reach), rest_(rest), order_(faces.face.size()), box_(faces.face.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  grow(faces, rest, 0, static_cast<Index>(order_.size()));
}

/// Halves a range of faces at the middle of its longest side.
void ContactSearch::grow(const ContactRegion& faces, const ContactPositions& rest, Index first, Index last) {
  const std::size_t self = tree_.size();
  tree_.push_back({Box{}, first, last, 0});
  if (last - first <= faces_per_leaf) return;
  const auto middle_of = [&](Index f) { return faces.face[at(f)].middle(rest); };
  Box box{middle_of(order_[at(first)]), middle_of(order_[at(first)])};
  for (Index n = first; n < last; ++n) box = around(box, {middle_of(order_[at(n)]), middle_of(order_[at(n)])});
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (box.high[i] - box.low[i] > box.high[axis] - box.low[axis]) axis = i;
  std::sort(order_.begin() + first, order_.begin() + last, [&](Index a, Index b) {
    const double x_a = middle_of(a)[axis], x_b = middle_of(b)[axis];
    return x_a < x_b || (x_a == x_b && a < b);
  });
  const Index half = first + (last - first) / 2;
  grow(faces, rest, first, half);
  tree_[self].right = static_cast<Index>(tree_.size());
  grow(faces, rest, half, last);
}

void ContactSearch::refit(const ContactRegion& faces, const ContactPositions& x) {
  for (std::size_t f = 0; f < box_.size(); ++f) box_[f] = faces.face[f].curved(x).box();
  for (std::size_t n = tree_.size(); n-- > 0;) {  // halves come after their parent
    Branch& branch = tree_[n];
    if (branch.right > 0) {
      branch.box = around(tree_[n + 1].box, tree_[at(branch.right)].box);
      continue;
    }
    branch.box = box_[at(order_[at(branch.first)])];
    for (Index f = branch.first; f < branch.last; ++f) branch.box = around(branch.box, box_[at(order_[at(f)])]);
  }
}

bool ContactSearch::is_due(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& x) const {
  if (slack_ < 0) return true;
  const Motion of_points = motion_of(points, searched_, x);
  if (&points == &faces) return !(2 * largest_shape_sum * of_points.deviation <= slack_);
  const Motion of_faces = motion_of(faces, searched_, x);
  const double closer =
      length(of_points.mean - of_faces.mean) + largest_shape_sum * (of_points.deviation + of_faces.deviation);
  return !(closer <= slack_);
}

void ContactSearch::update(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& x) {
  if (is_due(points, faces, x)) search(points, faces, x);
}

bool ContactSearch::are_neighbours(const ContactRegion& points, const ContactPoint& point, const ContactRegion& faces,
                                   Index face) const {
  const ContactFace &own = points.face[at(point.face)], &other = faces.face[at(face)];
  for (int a = 0; a < n_nodes_of(own.shape); ++a)
    for (int b = 0; b < n_nodes_of(other.shape); ++b)
      if (own.node[at(a)] == other.node[at(b)]) return true;
  return reach_.neighbour_distance > 0 && own.patch == other.patch &&
         closest_point(other.curved(rest_), points.position(point, rest_)).distance < reach_.neighbour_distance;
}

void ContactSearch::search(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& x) {
  ++n_searches_;
  searched_ = x;
  active_point_.clear();
  face_.clear();
  first_face_.assign(1, 0);
  refit(faces, x);
  const double within = reach_.reach + reach_.skin;

  Box all{x[at(points.node.front())], x[at(points.node.front())]};
  std::vector<NodeQuad> position;
  position.reserve(points.point.size());
  for (const ContactPoint& point : points.point) {
    position.push_back(points.position(point, x));
    all = around(all, {position.back(), position.back()});
  }
  const double apart = distance(all, tree_.front().box);
  slack_ = std::max(reach_.skin, apart - reach_.reach);
  if (apart > within) return;

  std::vector<Index> waiting, found;
  for (std::size_t p = 0; p < position.size(); ++p) {
    found.clear();
    waiting.assign(1, 0);
    while (!waiting.empty()) {
      const Index n = waiting.back();
      waiting.pop_back();
      const Branch& branch = tree_[at(n)];
      if (squared_distance(position[p], branch.box) > within * within) continue;
      if (branch.right > 0) {
        waiting.insert(waiting.end(), {n + 1, branch.right});
        continue;
      }
      for (Index f = branch.first; f < branch.last; ++f) {
        const Index face = order_[at(f)];
        if (squared_distance(position[p], box_[at(face)]) <= within * within &&
            !are_neighbours(points, points.point[p], faces, face))
          found.push_back(face);
      }
    }
    if (found.empty()) continue;
    std::sort(found.begin(), found.end());
    active_point_.push_back(static_cast<Index>(p));
    face_.insert(face_.end(), found.begin(), found.end());
    first_face_.push_back(face_.size());
  }
}

}  // namespace couplet::solid
