#pragma once
// The surfaces of all bodies over time, from what is known of each body before the start and how it is moved.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flow-server/immersed/moving_surface.hpp"
#include "flow-server/immersed/surface_tree.hpp"

namespace couplet::flow {

/// How the nodes of a body are moved at one time.
struct NodalMotion {
  double time = 0;                  // [s]
  surface::NodeArray displacement;  // (n_nodes, 3) from the mesh [m]
  surface::NodeArray velocity;      // (n_nodes, 3) [m/s]
};

/// A body moves as its setup prescribes, or from outside: then the motion of its nodes is given at the end of each
/// step. Between start and end of a step each node follows the cubic that has the given places and velocities at both
/// (Hermite), and its velocity changes in proportion to the time: it does not jump from one of several steps of the
/// flow to the next, which would be a spike of pressure of the size of 1 / dt, and the wall's acceleration is that of
/// the whole step in each. For a flow that takes the step at once the end alone counts, as it was given.
class BodySurfaces {
 public:
  /// Triangles where the setup gives no largest side have half the smallest cell around the body, attached edges go on
  /// for two cells. Throws SceneError for two bodies of one name, a closed body with a thickness, and what
  /// MovingSurface refuses. The grid must outlive this.
  BodySurfaces(std::vector<BodySetup> bodies, const StretchedGrid& grid);

  int n_bodies() const { return static_cast<int>(bodies_.size()); }
  const BodySetup& setup(int body) const { return bodies_[static_cast<std::size_t>(body)].setup; }
  const std::vector<std::string>& notes() const { return notes_; }  // sentences for the log

  /// All surfaces, in the order of the bodies. Before the start of a step that is given from outside it is as at its
  /// start, behind its end as at its end.
  std::vector<BodySurface> at(double time);

  /// Moves a body from outside: sets the end of the step, as often as it is tried. Places that differ by less than 1e-3
  /// cells from those of the trial before are left as they were, those within the step too; velocities are not: the
  /// force jumps where a surface leaves a cell, and iterations between flow and solid that come to stand there would go
  /// to and fro for ever. Throws SceneError where the setup prescribes another motion, and for a time that is not
  /// behind the start.
  void set_motion(int body, NodalMotion end);
  /// The end of the step is the start of the next one.
  void accept_motion();
  /// Where a body that is moved from outside starts: after a restart; at first it rests where its mesh is, at time 0.
  void set_start(int body, NodalMotion start);
  const std::optional<NodalMotion>& start(int body) const { return bodies_[static_cast<std::size_t>(body)].start; }

  /// Forces on the nodes of a body's mesh, (n_nodes, 3) [N], from those on the corners of its surface where it was last
  /// asked for: the exact transpose of how velocities of corners follow those of nodes.
  surface::NodeArray nodal_force(int body, std::span<const Point> corner_force) const;

  /// What is shown of a body, where it was last asked for: the first corners and triangles of its surface.
  const BodySurface& shown(int body) const { return bodies_[static_cast<std::size_t>(body)].surface.shown(); }
  /// Forces on the corners of shown() from those on all corners, with the same sum, moment and work.
  std::vector<Point> shown_force(int body, std::span<const Point> corner_force) const;

 private:
  struct Body {
    BodySetup setup;
    MovingSurface surface;
    double kept_distance;                   // [m]
    std::optional<NodalMotion> start, end;  // of the step, of a body that is moved from outside
    surface::NodeArray velocity_of_places;  // that of the end which places within the step follow
    std::optional<SurfaceTree> tree;        // of a closed body before which edges of sheets shut
  };
  void shut_edges();

  std::vector<Body> bodies_;
  std::vector<std::string> notes_;
};

}  // namespace couplet::flow
