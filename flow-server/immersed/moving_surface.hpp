#pragma once
// The surface of a body over time: from its setup to the triangles that cut the grid.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/body_setup.hpp"
#include "flow-server/immersed/edge_clearance.hpp"
#include "flow-server/immersed/edge_strip.hpp"
#include "flow-server/immersed/surface_tessellation.hpp"
#include "flow-server/immersed/surface_topology.hpp"
#include "flow-server/immersed/thick_sheet.hpp"

namespace couplet::flow {

/// Those of the grid, periodic ones too: a body that ends on both goes on for ever.
std::vector<BorderPlane> border_planes(const StretchedGrid& grid);

/// Largest side of the cell around a point, or of the nearest cell [m]; in two dimensions without z.
double cell_width_at(const StretchedGrid& grid, const Point& point);

/// Every rank holds the whole of it. Starts where the body is at time 0.
class MovingSurface {
 public:
  /// Throws SceneError by the name of the body for a surface that cannot be one (surface_topology.hpp) and for attached
  /// edges where there are none. `grid` must outlive this.
  /// `others`: closed bodies that may cover its holes.
  MovingSurface(const BodySetup& body, const StretchedGrid& grid, std::span<const BodySurface> others = {});

  /// Its prescribed motion at a time.
  void move_to(double time);

  /// Node by node, by what moves the body: (n_nodes, 3) [m], [m/s].
  void follow(const surface::NodeArray& node_position, const surface::NodeArray& node_velocity);

  /// The free edges of a sheet shut before the borders of the grid by themselves, before closed bodies when these are
  /// given here, at the same time.
  void shut_edges_before(std::span<const EdgeObstacle> obstacles);
  bool has_opening_edges() const { return strip_.has_value(); }

  /// What cuts the grid: the body; a sheet with the strip beyond its edges, its own corners and triangles first; or a
  /// sheet that was made thick.
  const BodySurface& surface() const;

  /// The body itself, without a strip, and where it ends: for distances from it.
  const BodySurface& body() const { return body_; }
  /// What is shown of it: the first corners and triangles of surface(), without a strip.
  const BodySurface& shown() const { return thick_ ? thick_->surface() : body_; }
  std::span<const FreeEdge> free_edges() const { return topology_.free_edge; }
  const std::vector<std::string>& notes() const { return topology_.notes; }

  /// Forces on the corners of surface() to the nodes of the body's mesh, (n_nodes, 3): the transpose of how velocities
  /// follow, so that sum and work are kept.
  void gather(std::vector<Point> corner_force, surface::NodeArray& nodal_force) const;
  /// The same to the corners of shown().
  void gather_on_shown(std::vector<Point>& corner_force) const;

 private:
  void update(std::span<const EdgeObstacle> obstacles = {});
  double cell_width(const Point& point) const { return cell_width_at(*grid_, point); }

  const StretchedGrid* grid_;
  PrescribedMotion motion_;
  SurfaceTessellation tessellation_;
  BodySurface body_;
  std::vector<Point> at_rest_;
  SurfaceTopology topology_;
  std::optional<EdgeStrip> strip_;
  std::optional<ThickSheet> thick_;
};

}  // namespace couplet::flow
