#include "flow-server/immersed/edge_strip.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace couplet::flow {
namespace {

constexpr double degree = std::numbers::pi / 180;
// Turns of the border: below fan_from one corner of the strip serves both sides.
constexpr double fan_from = 30 * degree, wide_fan_from = 75 * degree, concave_from = 10 * degree;

/// Distance of a point from the segment a-b.
double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double s = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  return distance(p, a + s * along);
}

}  // namespace

double EdgeRamp::opening(double s, double h) const {
  return std::max(0.5 + (s / h - shift) / length, 0.0);
}

EdgeStrip::EdgeStrip(const BodySurface& sheet, std::span<const FreeEdge> free_edges,
                     const std::vector<bool>& is_attached, const EdgeRamp& ramp, double attached_length,
                     const CellWidth& cell_width)
    : ramp_(ramp),
      attached_length_(attached_length),
      n_sheet_corners_(static_cast<int>(sheet.position.size())),
      n_sheet_triangles_(static_cast<int>(sheet.triangle.size())),
      surface_(sheet) {
  assert(is_attached.size() == free_edges.size());
  std::vector<int> attached, free;
  for (std::size_t i = 0; i < free_edges.size(); ++i) {
    const FreeEdge& edge = free_edges[i];
    const auto& corners = sheet.triangle[static_cast<std::size_t>(edge.triangle)];
    const int inner = corners[0] + corners[1] + corners[2] - edge.from - edge.to;
    (is_attached[i] ? attached : free).push_back(static_cast<int>(edge_.size()));
    edge_.push_back({edge.from, edge.to, inner});
  }
  add_strip(attached, true);
  const std::vector<int> beyond_walls = continue_beyond_walls(free);
  shut(cell_width, {});
  for (const Root& root : root_) place(root, cell_width);
  std::vector<int> all_free = free;
  all_free.insert(all_free.end(), beyond_walls.begin(), beyond_walls.end());
  add_strip(all_free, false);
  find_nearby_edges(all_free, cell_width);
  find_opened_corners(free, cell_width);
  update(sheet, cell_width);
}

/// One root for each corner of these edges; where two sheets meet in a corner each has its own.
void EdgeStrip::add_roots(std::span<const int> edges, bool is_attached) {
  std::vector<int> root_of(surface_.position.size(), -1);
  const auto join = [&](int corner, int edge, int Root::*side) {
    int& known = root_of[static_cast<std::size_t>(corner)];
    if (known < 0 || root_[static_cast<std::size_t>(known)].*side >= 0) {
      known = static_cast<int>(root_.size());
      root_.push_back({});
      root_.back().corner = corner;
      root_.back().is_attached = is_attached;
    }
    root_[static_cast<std::size_t>(known)].*side = edge;
  };
  for (const int e : edges) {
    join(edge_[static_cast<std::size_t>(e)].from, e, &Root::out);
    join(edge_[static_cast<std::size_t>(e)].to, e, &Root::in);
  }
}

void EdgeStrip::add_strip(std::span<const int> edges, bool is_attached) {
  const std::size_t first_root = root_.size();
  add_roots(edges, is_attached);
  auto n_corners = static_cast<int>(surface_.position.size());
  std::vector<int> starts(edge_.size(), -1), ends(edge_.size(), -1);  // the strip corner beside either end of an edge
  std::vector<char> ends_concave(edge_.size(), 0);                    // at its second end
  for (std::size_t r = first_root; r < root_.size(); ++r) {
    Root& root = root_[r];
    const double angle = !is_attached && root.in >= 0 && root.out >= 0 ? turn(root) : 0;
    root.n = angle > wide_fan_from ? 5 : angle > fan_from ? 3 : 1;
    root.first = n_corners;
    n_corners += root.n;
    if (root.in >= 0) {
      ends[static_cast<std::size_t>(root.in)] = root.first;
      ends_concave[static_cast<std::size_t>(root.in)] = angle < -concave_from;
    }
    if (root.out >= 0) starts[static_cast<std::size_t>(root.out)] = root.first + root.n - 1;
    for (int k = 1; k < root.n; ++k) surface_.triangle.push_back({root.corner, root.first + k - 1, root.first + k});
  }
  for (const int e : edges) {
    const Edge& edge = edge_[static_cast<std::size_t>(e)];
    const int a = starts[static_cast<std::size_t>(e)], b = ends[static_cast<std::size_t>(e)];
    if (ends_concave[static_cast<std::size_t>(e)]) {  // strip corners then lie on a line with that end
      surface_.triangle.push_back({edge.to, edge.from, b});
      surface_.triangle.push_back({edge.from, a, b});
    } else {
      surface_.triangle.push_back({edge.to, edge.from, a});
      surface_.triangle.push_back({edge.to, a, b});
    }
  }
  surface_.position.resize(static_cast<std::size_t>(n_corners));
  surface_.velocity.resize(static_cast<std::size_t>(n_corners));
  surface_.opening.resize(static_cast<std::size_t>(n_corners), 0.0);
  reach_.resize(static_cast<std::size_t>(n_corners - n_sheet_corners_), 0.0);
}

/// Where a free edge meets an attached one, the side of the attached strip is a free edge too: it goes straight on.
std::vector<int> EdgeStrip::continue_beyond_walls(std::span<const int> free) {
  std::vector<int> before(surface_.position.size(), -1), after(surface_.position.size(), -1), new_edges;
  std::vector<int> attached_start(edge_.size(), -1);  // the strip corner beside the start of an attached edge
  for (const int e : free) {
    const Edge& edge = edge_[static_cast<std::size_t>(e)];
    before[static_cast<std::size_t>(edge.to)] = edge.from;
    after[static_cast<std::size_t>(edge.from)] = edge.to;
  }
  for (const Root& root : root_)
    if (root.out >= 0) attached_start[static_cast<std::size_t>(root.out)] = root.first;
  for (Root& root : root_) {
    if (root.in >= 0 && root.out >= 0) continue;
    const bool starts = root.out >= 0;  // the attached edge does
    root.along = (starts ? before : after)[static_cast<std::size_t>(root.corner)];
    if (root.along < 0) continue;
    new_edges.push_back(static_cast<int>(edge_.size()));
    if (starts) {
      edge_.push_back({root.corner, root.first, edge_[static_cast<std::size_t>(root.out)].to});
    } else {
      edge_.push_back({root.first, root.corner, attached_start[static_cast<std::size_t>(root.in)]});
    }
  }
  return new_edges;
}

double EdgeStrip::distance_to(int edge, const Point& point) const {
  const Edge& e = edge_[static_cast<std::size_t>(edge)];
  return distance_to_segment(point, position(e.from), position(e.to));
}

/// Every free root learns which edges lie so near that their strips may meet: by a sweep along x.
void EdgeStrip::find_nearby_edges(std::span<const int> edges, const CellWidth& cell_width) {
  std::vector<std::pair<double, int>> by_x;
  double longest = 0;
  for (const int e : edges) {
    const Edge& edge = edge_[static_cast<std::size_t>(e)];
    by_x.emplace_back(position(edge.from)[0], e);
    longest = std::max(longest, distance(position(edge.from), position(edge.to)));
  }
  std::sort(by_x.begin(), by_x.end());
  for (Root& root : root_) {
    if (root.is_attached) continue;
    const Point& here = position(root.corner);
    // Two strips meet within twice their reach; looked for up to twice that.
    const double radius = 4 * ramp_.beyond() * cell_width(here);
    for (auto found = std::lower_bound(by_x.begin(), by_x.end(), std::pair{here[0] - radius - longest, -1});
         found != by_x.end() && found->first <= here[0] + radius + longest; ++found) {
      const Edge& edge = edge_[static_cast<std::size_t>(found->second)];
      if (edge.from != root.corner && edge.to != root.corner && distance_to(found->second, here) < radius)
        root.nearby.push_back(found->second);
    }
    std::sort(root.nearby.begin(), root.nearby.end());
  }
}

/// Corners that lie near a free edge, reached from it along the sides of triangles: a part of the sheet that is folded
/// over the edge does not count.
void EdgeStrip::find_opened_corners(std::span<const int> edges, const CellWidth& cell_width) {
  const auto n = static_cast<std::size_t>(n_sheet_corners_);
  std::vector<int> first(n + 1, 0), next_to;
  const auto n_triangles = static_cast<std::size_t>(n_sheet_triangles_);
  for (std::size_t t = 0; t < n_triangles; ++t)
    for (const int corner : surface_.triangle[t]) first[static_cast<std::size_t>(corner) + 1] += 2;
  for (std::size_t c = 0; c < n; ++c) first[c + 1] += first[c];
  next_to.resize(static_cast<std::size_t>(first[n]));
  std::vector<int> fill(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < n_triangles; ++t) {
    const auto& corners = surface_.triangle[t];
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3})
        next_to[static_cast<std::size_t>(fill[static_cast<std::size_t>(corners[k])]++)] = corners[other];
  }
  std::vector<int> seen_from(n, -1), reached;
  for (const int e : edges) {
    const Edge& edge = edge_[static_cast<std::size_t>(e)];
    const double radius = 2 * ramp_.before() * cell_width(position(edge.from));
    reached = {edge.from, edge.to};
    for (const int corner : reached) seen_from[static_cast<std::size_t>(corner)] = e;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      near_.push_back({reached[i], e});
      const auto corner = static_cast<std::size_t>(reached[i]);
      for (int k = first[corner]; k < first[corner + 1]; ++k) {
        const int other = next_to[static_cast<std::size_t>(k)];
        if (seen_from[static_cast<std::size_t>(other)] == e || distance_to(e, position(other)) > radius) continue;
        seen_from[static_cast<std::size_t>(other)] = e;
        reached.push_back(other);
      }
    }
  }
}

/// The in-plane normal of the border, away from the triangle.
template <class At>
MovingPoint EdgeStrip::outward(int edge, const At& at) const {
  const Edge& e = edge_[static_cast<std::size_t>(edge)];
  const MovingPoint start = at(e.from), along = at(e.to) - start;
  return cross(unit(along), unit(cross(along, at(e.inner) - start)));
}

/// Where the strip corners of a root lie, for a reach of one.
template <class At>
std::vector<MovingPoint> EdgeStrip::directions(const Root& root, const At& at) const {
  if (root.in < 0 || root.out < 0) {
    const MovingPoint out = outward(root.in < 0 ? root.out : root.in, at);
    if (root.along < 0) return {out};
    // Straight on along the free edge; a steep one is cut short.
    const MovingPoint on = unit(at(root.corner) - at(root.along));
    const MovingNumber share = dot(on, out);
    return {share.x > 0.3 ? inverse(share) * on : out};
  }
  const MovingPoint before = outward(root.in, at), after = outward(root.out, at);
  if (root.n == 1) {
    // The point at distance 1 from both borders: (m1 + m2) / (1 + m1 . m2); at most as far as at a turn of 120 degrees.
    const MovingNumber scale = 1 + dot(before, after);
    return {scale.x > 0.5 ? inverse(scale) * (before + after) : 2 * (before + after)};
  }
  // Halfway round the turn: m1 + m2 is short for a sharp corner, t1 - t2 for a blunt one; both point along it.
  const MovingPoint here = at(root.corner);
  const MovingPoint along_in = unit(here - at(edge_[static_cast<std::size_t>(root.in)].from));
  const MovingPoint along_out = unit(at(edge_[static_cast<std::size_t>(root.out)].to) - here);
  const MovingPoint middle = unit(before + after + (along_in - along_out));
  if (root.n == 3) return {before, middle, after};
  return {before, unit(before + middle), middle, unit(middle + after), after};
}

/// Angle by which the border turns at a root, positive at a convex corner.
double EdgeStrip::turn(const Root& root) const {
  const auto still = [this](int corner) { return MovingPoint{position(corner), {}}; };
  const Edge &in = edge_[static_cast<std::size_t>(root.in)], &out = edge_[static_cast<std::size_t>(root.out)];
  const Point along_in = unit(still(in.to) - still(in.from)).x, along_out = unit(still(out.to) - still(out.from)).x;
  const Point normal = cross(along_in, -1.0 * outward(root.in, still).x);  // t x (n x t) = n: outward is t x n
  return std::atan2(dot(cross(along_in, along_out), normal), dot(along_in, along_out));
}

/// Before a concave corner with turn a the strips end on the line midway: at a distance b along the border that is
/// b / tan(a / 2) away from it. The corner itself gets half of that for its shorter side, so that no triangle vanishes.
double EdgeStrip::concave_limit(const Root& root) const {
  if (root.in < 0 || root.out < 0) return 1e300;
  const double angle = -turn(root);
  if (angle < concave_from) return 1e300;
  const Edge &in = edge_[static_cast<std::size_t>(root.in)], &out = edge_[static_cast<std::size_t>(root.out)];
  const double side =
      std::min(distance(position(in.from), position(in.to)), distance(position(out.from), position(out.to)));
  return 0.5 * side / std::tan(angle / 2);
}

/// The largest reach up to the given one at which no other edge is nearer than the strip's own.
double EdgeStrip::free_reach(const Root& root, const Point& direction, double reach) const {
  const Point& here = position(root.corner);
  const auto is_own = [&](int edge, double r) { return distance_to(edge, here + r * direction) >= r * (1 - 1e-6); };
  for (const int edge : root.nearby) {
    if (is_own(edge, reach)) continue;
    double own = 0, other = reach;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (own + other);
      (is_own(edge, middle) ? own : other) = middle;
    }
    reach = own;
  }
  return reach;
}

void EdgeStrip::place(const Root& root, const CellWidth& cell_width) {
  const auto at = [this](int corner) {
    return MovingPoint{position(corner), surface_.velocity[static_cast<std::size_t>(corner)]};
  };
  const MovingPoint here = at(root.corner);
  const double h = root.is_attached ? 0 : cell_width(here.x);
  const double most = root.is_attached ? attached_length_ : std::min(ramp_.beyond() * h, concave_limit(root));
  const std::vector<MovingPoint> direction = directions(root, at);
  for (std::size_t k = 0; k < direction.size(); ++k) {
    const double reach = root.is_attached ? most : free_reach(root, direction[k].x, most);
    const MovingPoint corner = here + reach * direction[k];
    const std::size_t c = static_cast<std::size_t>(root.first) + k;
    surface_.position[c] = corner.x;
    surface_.velocity[c] = corner.u;
    surface_.opening[c] = root.is_attached ? surface_.opening[static_cast<std::size_t>(root.corner)]
                                           : ajar_[static_cast<std::size_t>(root.corner)] * ramp_.opening(reach, h);
    reach_[c - static_cast<std::size_t>(n_sheet_corners_)] = reach;
  }
}

/// How far edges are ajar.
void EdgeStrip::shut(const CellWidth& cell_width, const Clearance& clearance) {
  ajar_.assign(surface_.position.size(), 1.0);
  if (!clearance) return;
  const auto still = [this](int corner) { return MovingPoint{position(corner), {}}; };
  for (const Root& root : root_) {
    if (root.is_attached || root.corner >= n_sheet_corners_) continue;
    const std::vector<MovingPoint> direction = directions(root, still);
    const Point &here = position(root.corner), on = unit(direction[direction.size() / 2]).x;
    ajar_[static_cast<std::size_t>(root.corner)] =
        std::clamp(clearance(here, on) / (ramp_.shut_from * cell_width(here)), 0.0, 1.0);
  }
}

void EdgeStrip::update(const BodySurface& sheet, const CellWidth& cell_width, const Clearance& clearance) {
  assert(static_cast<int>(sheet.position.size()) == n_sheet_corners_);
  assert(static_cast<int>(sheet.triangle.size()) == n_sheet_triangles_);
  std::copy(sheet.position.begin(), sheet.position.end(), surface_.position.begin());
  std::copy(sheet.velocity.begin(), sheet.velocity.end(), surface_.velocity.begin());
  std::fill(surface_.opening.begin(), surface_.opening.begin() + n_sheet_corners_, 0.0);
  shut(cell_width, clearance);
  int last = -1;
  double h = 0;
  for (const NearEdge& pair : near_) {
    const Edge& edge = edge_[static_cast<std::size_t>(pair.edge)];
    if (pair.edge != last) h = cell_width(0.5 * (position(edge.from) + position(edge.to)));
    last = pair.edge;
    double& opening = surface_.opening[static_cast<std::size_t>(pair.corner)];
    const double ajar = 0.5 * (ajar_[static_cast<std::size_t>(edge.from)] + ajar_[static_cast<std::size_t>(edge.to)]);
    opening = std::max(opening, ajar * ramp_.opening(-distance_to(pair.edge, position(pair.corner)), h));
  }
  for (const Root& root : root_) place(root, cell_width);
}

void EdgeStrip::gather(std::vector<Point>& force) const {
  assert(force.size() == surface_.position.size());
  // Strip corner q of root v: u_q = u_v + r d'(u), linear in the velocities of the few corners that d depends on. Its
  // transpose is found by moving each of them along each axis. Last roots first: they may hang on the earlier ones.
  for (auto root = root_.rbegin(); root != root_.rend(); ++root) {
    std::vector<int> movers{root->corner};
    for (const int e : {root->in, root->out}) {
      if (e < 0) continue;
      const Edge& edge = edge_[static_cast<std::size_t>(e)];
      movers.insert(movers.end(), {edge.from, edge.to, edge.inner});
    }
    if (root->along >= 0) movers.push_back(root->along);
    std::sort(movers.begin(), movers.end());
    movers.erase(std::unique(movers.begin(), movers.end()), movers.end());
    for (const int mover : movers) {
      for (std::size_t d = 0; d < 3; ++d) {
        const auto at = [&](int corner) {
          MovingPoint moving{position(corner), {}};
          moving.u[d] = corner == mover ? 1 : 0;
          return moving;
        };
        const std::vector<MovingPoint> direction = directions(*root, at);
        const Point root_velocity = at(root->corner).u;
        double work = 0;
        for (std::size_t k = 0; k < direction.size(); ++k) {
          const std::size_t q = static_cast<std::size_t>(root->first) + k;
          const double reach = reach_[q - static_cast<std::size_t>(n_sheet_corners_)];
          work += dot(force[q], root_velocity + reach * direction[k].u);
        }
        force[static_cast<std::size_t>(mover)][d] += work;
      }
    }
  }
  force.resize(static_cast<std::size_t>(n_sheet_corners_));
}

}  // namespace couplet::flow
