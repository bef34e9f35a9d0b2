#include "flow-server/immersed/moving_surface.hpp"

#include <algorithm>
#include <limits>

#include "flow-server/immersed/covered_holes.hpp"
#include "flow-server/immersed/surface_tree.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

/// Says for each free edge whether both its ends lie in one of the boxes.
std::vector<bool> find_attached(const BodySetup& body, const BodySurface& at_rest, std::span<const FreeEdge> edges) {
  const auto lies_in = [&](int corner, const AttachedEdges& box) {
    const Point& p = at_rest.position[static_cast<std::size_t>(corner)];
    for (std::size_t d = 0; d < 3; ++d)
      if (p[d] < box.low[d] || p[d] > box.high[d]) return false;
    return true;
  };
  std::vector<bool> is_attached(edges.size(), false);
  for (std::size_t b = 0; b < body.attached.size(); ++b) {
    bool has_edge = false;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!lies_in(edges[i].from, body.attached[b]) || !lies_in(edges[i].to, body.attached[b])) continue;
      is_attached[i] = has_edge = true;
    }
    if (!has_edge) {
      throw report::SceneError("body '" + body.name + "'",
                               "box " + std::to_string(b) + " of its attached edges holds none",
                               "give a box around the edges that meet the wall, with the body at rest");
    }
  }
  return is_attached;
}

/// Width of the blend of a closed body with sharp edges [cells]. With the quarter of a cell that round bodies have, the
/// velocities beside an edge jump from those of the equations to the wall's as it moves on among the cells; the flow
/// leaves the edge too high or too low. The moment on a flag 4 cells thick, Reynolds number 20, is then off by -38 to
/// 39 %, by its place among the cells, with a whole cell by -15 to 15 % (26 % where its sides lie in faces and its end
/// does not; at most 9 % where its end lies in a face).
constexpr double blend_at_sharp_edges = 1;

/// Lids of rims that lie inside other bodies, or on them: round-off and chords of round bodies are far below a cell.
int close_holes(BodySurface& surface, FluidSide fluid, std::span<const BorderPlane> planes, const StretchedGrid& grid,
                std::span<const BodySurface> others) {
  surface.is_closed = false;
  const SurfaceTopology topology = orient_surface(surface, fluid, planes);
  surface.is_closed = true;
  std::vector<SurfaceTree> trees;
  for (const BodySurface& other : others) {
    const std::array<SurfaceInTree, 1> in_tree{SurfaceInTree{&other, {}, static_cast<int>(other.triangle.size())}};
    trees.emplace_back(in_tree);
  }
  const auto is_covered = [&](const Point& corner) {
    for (int d = 0; d < grid.n_dimensions; ++d) {
      const StretchedAxis& axis = grid.axis[static_cast<std::size_t>(d)];
      const double at = corner[static_cast<std::size_t>(d)];
      if (!axis.is_periodic() && (at <= axis.start() || at >= axis.end())) return true;
    }
    for (std::size_t o = 0; o < others.size(); ++o) {
      const ClosestPoint closest = trees[o].closest(corner, std::numeric_limits<double>::infinity());
      if (!closest.is_found()) continue;
      const auto& [a, b, c] = others[o].triangle[static_cast<std::size_t>(closest.triangle)];
      const std::vector<Point>& at = others[o].position;
      const Point area = area_vector(at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)],
                                     at[static_cast<std::size_t>(c)]);
      const double outwards = dot(area, corner - closest.position);
      if (outwards <= 0 || closest.distance <= 0.5 * cell_width_at(grid, corner)) return true;
    }
    return false;
  };
  return close_covered_holes(surface, topology, is_covered);
}

}  // namespace

std::vector<BorderPlane> border_planes(const StretchedGrid& grid) {
  std::vector<BorderPlane> planes;
  for (int d = 0; d < 3; ++d) {
    const StretchedAxis& axis = grid.axis[static_cast<std::size_t>(d)];
    planes.push_back({d, axis.start()});
    planes.push_back({d, axis.end()});
  }
  return planes;
}

double cell_width_at(const StretchedGrid& grid, const Point& point) {
  double width = 0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(grid.n_dimensions); ++d) {
    const std::vector<double>& faces = grid.axis[d].faces();
    const auto after = std::upper_bound(faces.begin() + 1, faces.end() - 1, point[d]);
    width = std::max(width, *after - *(after - 1));
  }
  return width;
}

MovingSurface::MovingSurface(const BodySetup& body, const StretchedGrid& grid, std::span<const BodySurface> others)
    : grid_(&grid),
      motion_(body.motion),
      tessellation_(body.mesh, "body '" + body.name + "'",
                    {.largest_side = body.largest_side, .is_two_dimensional = grid.n_dimensions == 2}) {
  body_.name = body.name;
  body_.is_closed = body.is_closed;
  body_.is_lumen = body.is_closed && body.fluid == FluidSide::inside;
  body_.blend_width = body.blend_width;
  body_.edge_conductance = body.edge_conductance;
  body_.is_fixed = body.is_closed && body.motion.is_fixed() && !body.is_moved_from_outside;
  body_.triangle = tessellation_.triangle();
  tessellation_.interpolate(body.mesh.node_position, body_.position);
  body_.velocity.assign(body_.position.size(), Point{});
  std::vector<BorderPlane> planes = border_planes(grid);
  if (grid.n_dimensions == 2) {  // a body ends where its mesh does along z, whatever its depth
    const auto depth = body.mesh.node_position.col(2);
    planes.insert(planes.end(), {{2, depth.minCoeff()}, {2, depth.maxCoeff()}});
  }
  const int n_lids =
      body.is_closed && body.closes_covered_holes ? close_holes(body_, body.fluid, planes, grid, others) : 0;
  topology_ = orient_surface(body_, body.fluid, planes);
  if (n_lids > 0)
    topology_.notes.push_back(
        "body '" + body.name + "': " + std::to_string(n_lids) +
        (n_lids == 1 ? " hole, which no fluid reaches, was closed" : " holes, which no fluid reaches, were closed"));
  if (body.is_closed) {
    const auto without_lids = std::span(body_.triangle).first(tessellation_.triangle().size());
    body_.sharp_edge = find_sharp_edges(body_.position, without_lids);
    const bool has_edge = std::any_of(body_.sharp_edge.begin(), body_.sharp_edge.end(),
                                      [](const SharpEdge& edge) { return edge.is_convex; });
    if (has_edge && !body.blend_width) body_.blend_width = blend_at_sharp_edges;
  }
  at_rest_ = body_.position;
  if (!body.is_closed) {
    const std::vector<bool> is_attached = find_attached(body, body_, topology_.free_edge);
    if (body.thickness > 0) {
      thick_.emplace(body_, topology_, body.thickness);
    } else {
      strip_.emplace(body_, topology_.free_edge, is_attached, body.edge, body.attached_length,
                     [this](const Point& point) { return cell_width(point); });
    }
  }
  move_to(0);
}

void MovingSurface::update(std::span<const EdgeObstacle> obstacles) {
  if (strip_)
    strip_->update(
        body_, [this](const Point& point) { return cell_width(point); },
        [&](const Point& from, const Point& direction) {
          return edge_clearance(*grid_, obstacles, from, direction, cell_width(from));
        });
  if (thick_) thick_->update(body_);
}

void MovingSurface::move_to(double time) {
  motion_.move(at_rest_, time, body_);
  update();
}

void MovingSurface::follow(const surface::NodeArray& node_position, const surface::NodeArray& node_velocity) {
  tessellation_.interpolate(node_position, body_.position);
  tessellation_.interpolate(node_velocity, body_.velocity);
  update();
}

void MovingSurface::shut_edges_before(std::span<const EdgeObstacle> obstacles) {
  update(obstacles);
}

const BodySurface& MovingSurface::surface() const {
  return strip_ ? strip_->surface() : thick_ ? thick_->surface() : body_;
}

void MovingSurface::gather_on_shown(std::vector<Point>& corner_force) const {
  if (strip_) strip_->gather(corner_force);
}

void MovingSurface::gather(std::vector<Point> corner_force, surface::NodeArray& nodal_force) const {
  if (strip_) strip_->gather(corner_force);
  if (thick_) thick_->gather(corner_force);
  tessellation_.gather(corner_force, nodal_force);
}

}  // namespace couplet::flow
