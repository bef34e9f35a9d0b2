#pragma once
// How far obstacles stand before the free edge of a sheet.

#include <span>

#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/immersed/surface_tree.hpp"

namespace couplet::flow {

/// A closed body before which edges shut.
struct EdgeObstacle {
  const BodySurface* surface;
  const SurfaceTree* tree;  // of it
};

/// From a point of an edge straight on along a unit vector to the first border of the grid or closed body [m], 0 where
/// they touch and inside; infinite where nothing stands nearer than `reach`, or only what the edge passes by. Bodies
/// count as flat there.
double edge_clearance(const StretchedGrid& grid, std::span<const EdgeObstacle> obstacles, const Point& from,
                      const Point& direction, double reach);

}  // namespace couplet::flow
