#include "flow-server/immersed/edge_crossings.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace couplet::flow {

namespace {

/// A crossing is never nearer to a corner than this share of the edge.
constexpr double nearest_to_corner = 1e-9;
/// Surfaces are moved by these shares of the smallest cell: irrational to each other, far below any error.
constexpr std::array<double, 3> nudges{1.0e-9, 1.4142135623730951e-9, 1.7320508075688772e-9};

/// Twice the area of the triangle (a, b, p) in a plane, with the same rounding from whichever triangle the edge a - b
/// is seen: `is_reversed` tells that a has the higher number.
double side_of_edge(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p, bool is_reversed) {
  const Eigen::Vector2d& from = is_reversed ? b : a;
  const Eigen::Vector2d& to = is_reversed ? a : b;
  double area = (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]);
  if (area == 0) area = 1e-300;  // on the edge: to the same side for both
  return is_reversed ? -area : area;
}

}  // namespace

EdgeCrossings::EdgeCrossings(const StretchedGrid& grid, const Box& mine, int layers)
    : grid_(grid), is_flat_(grid.n_dimensions == 2), bends_(is_flat_) {
  Box all;
  for (int d = 0; d < 3; ++d) {
    const StretchedAxis& axis = grid.axis[d];
    const int around = is_flat_ && d == 2 ? 0 : layers;
    all.begin[d] = mine.begin[d] - around;
    all.end[d] = mine.end[d] + around;
    if (!axis.is_periodic()) {
      all.begin[d] = std::max(all.begin[d], 0);
      all.end[d] = std::min(all.end[d], axis.n_cells());
    }
    for (int i = all.begin[d]; i <= all.end[d]; ++i) corners_[d].push_back(axis.face(i));
    nudge_[d] = nudges[static_cast<std::size_t>(d)] * axis.smallest_width();
  }
  cells_ = all.relative_to(mine.begin);
  images_ = {Eigen::Vector3d::Zero()};
  for (int d = 0; d < grid.n_dimensions; ++d) {
    if (!grid.axis[d].is_periodic()) continue;
    const std::size_t n = images_.size();
    for (std::size_t i = 0; i < n; ++i)
      for (const double sign : {-1.0, 1.0}) {
        Eigen::Vector3d shift = images_[i];
        shift[d] += sign * grid.axis[d].length();
        images_.push_back(shift);
      }
  }
  // One more edge than cells across; ghost layers take negative indices.
  Triple sizes, before;
  for (int d = 0; d < 3; ++d) {
    sizes[d] = std::max(cells_.end[d], 1) + 1;
    before[d] = std::max(-cells_.begin[d], 0);
  }
  for (int d = 0; d < grid.n_dimensions; ++d) place_[d] = Field<int>(sizes, before);
}

void EdgeCrossings::update(std::span<const BodySurface> surfaces) {
  for (const Edge& edge : crossed_) place_[edge.direction](edge.corner[0], edge.corner[1], edge.corner[2]) = 0;
  found_.clear();
  passages_.clear();
  has_lumen_ = std::any_of(surfaces.begin(), surfaces.end(), [](const BodySurface& s) { return s.is_lumen; });
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (const Eigen::Vector3d& shift : images_)
      for (std::size_t t = 0; t < surfaces[s].triangle.size(); ++t)
        add_triangle(surfaces[s], static_cast<int>(s), static_cast<int>(t), shift);
  sort_crossings();
  find_inside();
  std::vector<Eigen::Vector3d> shifts = images_;
  for (Eigen::Vector3d& shift : shifts) shift += nudge_;
  bends_.update(surfaces, shifts, cells_, corners_);
}

void EdgeCrossings::add_triangle(const BodySurface& surface, int surface_index, int triangle,
                                 const Eigen::Vector3d& shift) {
  std::array<Eigen::Vector3d, 3> vertex;
  Eigen::Vector3d low, high;
  for (std::size_t v = 0; v < 3; ++v) {
    const Point& position =
        surface.position[static_cast<std::size_t>(surface.triangle[static_cast<std::size_t>(triangle)][v])];
    for (int d = 0; d < 3; ++d) vertex[v][d] = position[d] + shift[d] + nudge_[d];
    low = v == 0 ? vertex[v] : Eigen::Vector3d(low.cwiseMin(vertex[v]));
    high = v == 0 ? vertex[v] : Eigen::Vector3d(high.cwiseMax(vertex[v]));
  }
  // Along x all of the line matters: what is inside is counted from its start.
  for (int d = 1; d < grid_.n_dimensions; ++d)
    if (high[d] < corners_[d].front() || low[d] > corners_[d].back()) return;
  const bool is_near = high[0] >= corners_[0].front() && low[0] <= corners_[0].back();
  if (is_near || surface.is_closed) cross_lines(surface, surface_index, triangle, vertex, 0);
  for (int d = 1; d < grid_.n_dimensions && is_near; ++d) cross_lines(surface, surface_index, triangle, vertex, d);
}

/// Lines along d through corners of cells, as far as they meet the triangle.
void EdgeCrossings::cross_lines(const BodySurface& surface, int surface_index, int triangle,
                                const std::array<Eigen::Vector3d, 3>& vertex, int d) {
  const int e = (d + 1) % 3, f = (d + 2) % 3;
  const Eigen::Vector3d normal = (vertex[1] - vertex[0]).cross(vertex[2] - vertex[0]);
  if (normal[d] == 0) return;
  const std::array<int, 3>& corner = surface.triangle[static_cast<std::size_t>(triangle)];
  std::array<Eigen::Vector2d, 3> flat;
  for (std::size_t v = 0; v < 3; ++v) flat[v] = {vertex[v][e], vertex[v][f]};
  // Corners of the lattice inside the triangle's range along an axis; the middle plane alone where there is one cell.
  const double middle = is_flat_ ? grid_.axis[2].centre(0) : 0;
  const auto range_of = [&](int axis) -> Interval {
    if (is_flat_ && axis == 2) return {0, 1};
    const double low = std::min({vertex[0][axis], vertex[1][axis], vertex[2][axis]});
    const double high = std::max({vertex[0][axis], vertex[1][axis], vertex[2][axis]});
    const std::vector<double>& at = corners_[axis];
    return {static_cast<int>(std::lower_bound(at.begin(), at.end(), low) - at.begin()),
            static_cast<int>(std::upper_bound(at.begin(), at.end(), high) - at.begin())};
  };
  const auto position_of = [&](int axis, int i) {
    return is_flat_ && axis == 2 ? middle : corners_[axis][static_cast<std::size_t>(i)];
  };
  const Interval along_e = range_of(e), along_f = range_of(f);
  const std::vector<double>& along = corners_[d];
  for (int b = along_f.begin; b < along_f.end; ++b)
    for (int a = along_e.begin; a < along_e.end; ++a) {
      const Eigen::Vector2d p{position_of(e, a), position_of(f, b)};
      std::array<double, 3> area;
      for (std::size_t v = 0; v < 3; ++v) {
        const std::size_t next = (v + 1) % 3;
        area[(v + 2) % 3] = side_of_edge(flat[v], flat[next], p, corner[v] > corner[next]);
      }
      const bool is_hit =
          normal[d] > 0 ? area[0] > 0 && area[1] > 0 && area[2] > 0 : area[0] < 0 && area[1] < 0 && area[2] < 0;
      if (!is_hit) continue;
      const double whole = area[0] + area[1] + area[2];
      EdgeCrossing crossing;
      crossing.weight = Eigen::Vector3d(area[0], area[1], area[2]) / whole;
      const double x =
          crossing.weight[0] * vertex[0][d] + crossing.weight[1] * vertex[1][d] + crossing.weight[2] * vertex[2][d];
      // The side of a corner is that of the triangle's plane, computed alike for all lines through the corner.
      const auto is_behind = [&](int i) {
        Eigen::Vector3d at;
        at[d] = along[static_cast<std::size_t>(i)], at[e] = p[0], at[f] = p[1];
        const double height = normal[0] * (at[0] - vertex[0][0]) + normal[1] * (at[1] - vertex[0][1]) +
                              normal[2] * (at[2] - vertex[0][2]);
        return normal[d] > 0 ? height >= 0 : height < 0;
      };
      int behind = static_cast<int>(std::lower_bound(along.begin(), along.end(), x) - along.begin());
      const int n = static_cast<int>(along.size());
      while (behind > 0 && is_behind(behind - 1)) --behind;
      while (behind < n && !is_behind(behind)) ++behind;
      if (d == 0 && surface.is_closed) {
        const std::size_t line = static_cast<std::size_t>(a) + static_cast<std::size_t>(b) * corners_[1].size();
        // Normals point to the fluid: against them it goes into a body, with them into a lumen.
        passages_.push_back({line, behind, (normal[0] < 0) != surface.is_lumen ? 1 : -1, surface.is_lumen});
      }
      if (behind == 0 || behind == n) continue;
      const double start = along[static_cast<std::size_t>(behind - 1)], end = along[static_cast<std::size_t>(behind)];
      crossing.share = std::clamp((x - start) / (end - start), nearest_to_corner, 1 - nearest_to_corner);
      crossing.surface = surface_index;
      crossing.triangle = triangle;
      crossing.leads_out = normal[d] > 0;
      crossing.velocity.setZero();
      for (std::size_t v = 0; v < 3; ++v) {
        const auto c = static_cast<std::size_t>(corner[v]);
        const double weight = crossing.weight[static_cast<int>(v)];
        if (!surface.opening.empty()) crossing.opening += weight * surface.opening[c];
        for (int q = 0; q < 3; ++q) crossing.velocity[q] += weight * surface.velocity[c][q];
      }
      crossing.opening = std::min(crossing.opening, 1.0);
      Triple at;
      at[d] = behind - 1 + cells_.begin[d], at[e] = a + cells_.begin[e], at[f] = b + cells_.begin[f];
      found_.push_back({edge_index(d, at), crossing});
    }
}

std::size_t EdgeCrossings::edge_index(int d, const Triple& corner) const {
  std::size_t index = static_cast<std::size_t>(d);
  for (int e = 2; e >= 0; --e)
    index = index * corners_[e].size() + static_cast<std::size_t>(corner[e] - cells_.begin[e]);
  return index;
}

void EdgeCrossings::sort_crossings() {
  // Equal places are ordered by surface and triangle, so that all ranks see the same order.
  order_.resize(found_.size());
  for (std::size_t c = 0; c < found_.size(); ++c) order_[c] = {found_[c].edge, static_cast<int>(c)};
  std::sort(order_.begin(), order_.end(), [this](const Order& a, const Order& b) {
    if (a.edge != b.edge) return a.edge < b.edge;
    const EdgeCrossing& one = found_[static_cast<std::size_t>(a.found)].crossing;
    const EdgeCrossing& other = found_[static_cast<std::size_t>(b.found)].crossing;
    return std::tie(one.share, one.surface, one.triangle) < std::tie(other.share, other.surface, other.triangle);
  });
  crossings_.clear();
  first_.assign(1, 0);
  crossed_.clear();
  for (std::size_t c = 0; c < order_.size(); ++c) {
    const bool is_new = c == 0 || order_[c].edge != order_[c - 1].edge;
    if (is_new && c > 0) first_.push_back(c);
    if (is_new) {
      Edge edge;
      std::size_t rest = order_[c].edge;
      for (int e = 0; e < 3; ++e) {
        edge.corner[e] = static_cast<int>(rest % corners_[e].size()) + cells_.begin[e];
        rest /= corners_[e].size();
      }
      edge.direction = static_cast<int>(rest);
      crossed_.push_back(edge);
      place_[edge.direction](edge.corner[0], edge.corner[1], edge.corner[2]) = static_cast<int>(crossed_.size());
    }
    crossings_.push_back(found_[static_cast<std::size_t>(order_[c].found)].crossing);
  }
  if (!found_.empty()) first_.push_back(found_.size());
}

/// Solid is what lies in a body, and outside all lumens where there are any.
void EdgeCrossings::find_inside() {
  inside_.clear();
  if (passages_.empty() && !has_lumen_) return;
  std::sort(passages_.begin(), passages_.end(), [](const Passage& a, const Passage& b) {
    return std::tie(a.line, a.corner, b.change) < std::tie(b.line, b.corner, a.change);  // in before out
  });
  inside_.resize(corners_[1].size() * corners_[2].size());
  std::size_t p = 0;
  for (std::size_t line = 0; line < inside_.size(); ++line) {
    int n_bodies = 0, n_lumens = 0, since = 0;
    const auto is_solid = [&] { return n_bodies > 0 || (has_lumen_ && n_lumens <= 0); };
    const auto close = [&](int corner) {
      if (corner > since) inside_[line].push_back({since + cells_.begin[0], corner + cells_.begin[0]});
    };
    for (; p < passages_.size() && passages_[p].line == line; ++p) {
      const bool was_solid = is_solid();
      (passages_[p].is_lumen ? n_lumens : n_bodies) += passages_[p].change;
      if (was_solid && !is_solid()) close(passages_[p].corner);
      if (!was_solid && is_solid()) since = passages_[p].corner;
    }
    if (is_solid()) close(static_cast<int>(corners_[0].size()));
  }
}

std::span<const Interval> EdgeCrossings::inside(int j, int k) const {
  if (inside_.empty()) return {};
  return inside_[static_cast<std::size_t>(j - cells_.begin[1]) +
                 static_cast<std::size_t>(is_flat_ ? 0 : k - cells_.begin[2]) * corners_[1].size()];
}

bool EdgeCrossings::is_inside(const Triple& corner) const {
  for (const Interval& interval : inside(corner[1], corner[2]))
    if (corner[0] >= interval.begin && corner[0] < interval.end) return true;
  return false;
}

bool EdgeCrossings::is_looked_at(int d, const Triple& corner) const {
  for (int e = 0; e < 3; ++e)
    if (corner[e] < cells_.begin[e] || corner[e] > cells_.end[e] - (e == d ? 1 : 0)) return false;
  return true;
}

std::span<const EdgeCrossing> EdgeCrossings::on_edge(int d, const Triple& corner) const {
  if (is_flat_ && d == 2) return {};
  Triple at = corner;
  if (is_flat_) at[2] = 0;
  if (!is_looked_at(d, at)) return {};
  const int place = place_[d](at[0], at[1], at[2]);
  if (place == 0) return {};
  return {crossings_.data() + first_[static_cast<std::size_t>(place - 1)],
          crossings_.data() + first_[static_cast<std::size_t>(place)]};
}

}  // namespace couplet::flow
