#include "flow-server/immersed/body_surfaces.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "flow-server/immersed/covered_holes.hpp"
#include "flow-server/immersed/surface_tree.hpp"
#include "flow-server/immersed/triangle_geometry.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

std::string named(const BodySetup& setup) {
  return "body '" + setup.name + "'";
}

double smallest_width_around(const StretchedGrid& grid, const surface::SurfaceMesh& mesh) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int d = 0; d < grid.n_dimensions; ++d) {
    const StretchedAxis& axis = grid.axis[static_cast<std::size_t>(d)];
    const double low = mesh.node_position.col(d).minCoeff(), high = mesh.node_position.col(d).maxCoeff();
    for (int i = 0; i < axis.n_cells(); ++i)
      if ((axis.face(i + 1) >= low || i == axis.n_cells() - 1) && (axis.face(i) <= high || i == 0))
        smallest = std::min(smallest, axis.width(i));
  }
  return smallest;
}

/// With lengths in the place of those that follow from the grid.
BodySetup completed(BodySetup setup, const StretchedGrid& grid) {
  surface::check_surface(setup.mesh, named(setup));
  if (setup.largest_side <= 0 && setup.mesh.n_nodes() > 0)
    setup.largest_side = 0.5 * smallest_width_around(grid, setup.mesh);
  if (setup.attached_length <= 0)
    for (const AttachedEdges& box : setup.attached)
      setup.attached_length = std::max(setup.attached_length, 2 * cell_width_at(grid, 0.5 * (box.low + box.high)));
  return setup;
}

/// What a body may miss of the places it is given in the iterations of a step, in smallest cells around it. A flag
/// whose end passes a plane of the grid takes 9 iterations in that step; with a tenth of it 16, with a hundredth up to
/// 44, and on other ranks others. A hundredth of a cell changes nothing more.
constexpr double share_of_cell_kept = 1e-3;

/// Steps of the flow that are summed arrive at the end of theirs but for round-off: as a share of the whole.
constexpr double round_off_of_times = 1e-9;

/// Places on the cubic in time with the places and velocities of both ends, velocities in proportion: over the steps of
/// the flow within that of the solid the acceleration is one number, which the displacement has no part in. With the
/// rate of the cubic the last of two steps feels 5 times the change of the velocity less 6 times that of the
/// displacement, and a swinging flag took 15 iterations and more where it takes 3, its lift jumping to and fro.
NodalMotion between(const NodalMotion& start, const NodalMotion& end, const surface::NodeArray& velocity_of_places,
                    double time) {
  const double length = end.time - start.time, s = std::clamp((time - start.time) / length, 0.0, 1.0), r = 1 - s;
  if (r < round_off_of_times) return end;
  if (s < round_off_of_times) return start;
  NodalMotion motion{time, {}, {}};
  motion.displacement = (1 + 2 * s) * r * r * start.displacement + s * s * (3 - 2 * s) * end.displacement +
                        length * s * r * (r * start.velocity - s * velocity_of_places);
  motion.velocity = r * start.velocity + s * end.velocity;
  return motion;
}

}  // namespace

BodySurfaces::BodySurfaces(std::vector<BodySetup> bodies, const StretchedGrid& grid) {
  std::set<std::string> names;
  for (BodySetup& given : bodies) {
    if (!names.insert(given.name).second)
      throw report::SceneError(named(given), "there are two of this name", "give each body its own");
    if (given.is_closed && given.thickness > 0)
      throw report::SceneError(named(given), "is closed and has a thickness of " + report::text(given.thickness) + " m",
                               "call it thin, or leave out the thickness");
  }
  // Those first in which others may end.
  std::vector<std::optional<Body>> made(bodies.size());
  std::vector<BodySurface> closed;
  for (const bool is_last : {false, true})
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].closes_covered_holes != is_last) continue;
      BodySetup setup = completed(std::move(bodies[b]), grid);
      MovingSurface surface(setup, grid, closed);
      notes_.insert(notes_.end(), surface.notes().begin(), surface.notes().end());
      if (setup.is_closed) closed.push_back(surface.surface());
      const double kept = share_of_cell_kept * smallest_width_around(grid, setup.mesh);
      made[b] = Body{std::move(setup), std::move(surface), kept, {}, {}, {}, {}};
    }
  for (std::optional<Body>& body : made) bodies_.push_back(std::move(*body));
}

std::vector<BodySurface> BodySurfaces::at(double time) {
  std::vector<BodySurface> surfaces;
  for (Body& body : bodies_) {
    if (body.start) {
      const NodalMotion motion =
          body.end ? between(*body.start, *body.end, body.velocity_of_places, time) : *body.start;
      body.surface.follow(body.setup.mesh.node_position + motion.displacement, motion.velocity);
    } else {
      body.surface.move_to(time);
    }
  }
  shut_edges();
  for (const Body& body : bodies_) surfaces.push_back(body.surface.surface());
  return surfaces;
}

/// Free edges of sheets before closed bodies, all of them in their present place.
void BodySurfaces::shut_edges() {
  const auto has_edges = [](const Body& body) { return body.surface.has_opening_edges(); };
  if (std::none_of(bodies_.begin(), bodies_.end(), has_edges)) return;
  std::vector<EdgeObstacle> obstacles;
  for (Body& body : bodies_) {
    if (!body.setup.is_closed) continue;
    const BodySurface& surface = body.surface.surface();
    const std::array<SurfaceInTree, 1> in_tree{SurfaceInTree{&surface, {}, static_cast<int>(surface.triangle.size())}};
    if (!body.tree) {
      body.tree.emplace(in_tree);
    } else if (!surface.is_fixed) {
      body.tree->refit(in_tree);
    }
    obstacles.push_back({&surface, &*body.tree});
  }
  if (obstacles.empty()) return;
  for (Body& body : bodies_)
    if (has_edges(body)) body.surface.shut_edges_before(obstacles);
}

void BodySurfaces::set_start(int index, NodalMotion start) {
  Body& body = bodies_[static_cast<std::size_t>(index)];
  const auto n_nodes = body.setup.mesh.n_nodes();
  if (!body.setup.motion.is_fixed())
    throw report::SceneError(named(body.setup), "is moved from outside and has a prescribed motion too",
                             "leave out one of them");
  const auto fits = [&](const surface::NodeArray& array) { return array.rows() == n_nodes && array.cols() == 3; };
  if (!fits(start.displacement) || !fits(start.velocity))
    throw report::SceneError(named(body.setup),
                             "is given a motion of another number of nodes than its " + std::to_string(n_nodes));
  body.start = std::move(start);
  body.end.reset();
}

void BodySurfaces::set_motion(int index, NodalMotion end) {
  Body& body = bodies_[static_cast<std::size_t>(index)];
  const surface::NodeArray at_rest = surface::NodeArray::Zero(body.setup.mesh.n_nodes(), 3);
  if (!body.start) set_start(index, {0, at_rest, at_rest});
  if (end.displacement.rows() != at_rest.rows() || end.velocity.rows() != at_rest.rows())
    throw report::SceneError(named(body.setup), "is given a motion of " + std::to_string(end.displacement.rows()) +
                                                    " nodes but has " + std::to_string(at_rest.rows()));
  if (!(end.time > body.start->time))
    throw report::SceneError(named(body.setup), "is given a motion at t = " + report::text(end.time) +
                                                    " s, not behind the start of the step at " +
                                                    report::text(body.start->time) + " s");
  const bool is_kept = body.end && body.end->time == end.time &&
                       (end.displacement - body.end->displacement).cwiseAbs().maxCoeff() < body.kept_distance;
  if (is_kept)
    end.displacement = body.end->displacement;
  else
    body.velocity_of_places = end.velocity;
  body.end = std::move(end);
}

void BodySurfaces::accept_motion() {
  for (Body& body : bodies_) {
    if (!body.end) continue;
    body.start = std::move(body.end);
    body.end.reset();
  }
}

std::vector<Point> BodySurfaces::shown_force(int index, std::span<const Point> corner_force) const {
  std::vector<Point> force(corner_force.begin(), corner_force.end());
  bodies_[static_cast<std::size_t>(index)].surface.gather_on_shown(force);
  return force;
}

surface::NodeArray BodySurfaces::nodal_force(int index, std::span<const Point> corner_force) const {
  surface::NodeArray nodal;
  bodies_[static_cast<std::size_t>(index)].surface.gather({corner_force.begin(), corner_force.end()}, nodal);
  return nodal;
}

}  // namespace couplet::flow
