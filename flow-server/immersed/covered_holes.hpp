#pragma once
// Holes of a surface that no fluid reaches, closed.

#include <functional>
#include <span>

#include "flow-server/immersed/surface_topology.hpp"

namespace couplet::flow {

/// Adds a lid to each hole whose rim is covered: triangles between corners of the rim, so that the surface has no new
/// corners. A rim is a closed chain of free edges; or, where chains end on a border of the grid, both of them in two
/// dimensions (a wetted surface that ends on both sides of the place where the solid is held) and in three dimensions
/// the one chain, closed along the border. Of all such triangulations of a rim the one with the best shaped triangles
/// is taken, by dynamic programming over its corners [G. Barequet, M. Sharir, Comput. Aided Geom. Des. 12 (1995) 207].
/// `topology`: of the surface as it is. `is_covered`: of a corner of the rim; a hole with one that is not stays open.
/// Returns the number of lids.
int close_covered_holes(BodySurface& surface, const SurfaceTopology& topology,
                        const std::function<bool(const Point&)>& is_covered);

}  // namespace couplet::flow
