#pragma once
// Bodies of simple shape as meshes of triangles.

#include <array>
#include <vector>

#include "flow-server/boundary/space_time_value.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

using PlanePoint = std::array<double, 2>;  // x, y [m]

/// What a shape in the x-y plane spans along z, from border to border of the grid.
struct DepthSpan {
  double from = 0;          // [m]
  double to = 1;            // [m]
  bool is_one_cell = true;  // two dimensions: one layer of triangles; else as many as their size asks for
};

// All are made of triangles whose sides (in two dimensions: along the outline) are at most `largest_side` [m] long.
// Normals point out of closed bodies. Triangles of ellipses and ellipsoids cut into the true surface as much as their
// corners stand out of it, by a share of (side / radius)^2 / 8 or less: the body has the true volume.

/// Prism over an ellipse with half-axes along x and y [m], without lids.
surface::SurfaceMesh make_elliptic_cylinder(const PlanePoint& centre, const PlanePoint& half_axes,
                                            const DepthSpan& depth, double largest_side);

/// Prism over a closed polygon, without lids. The points go round in either direction; the last is joined to the first.
surface::SurfaceMesh make_polygon_prism(const std::vector<PlanePoint>& outline, const DepthSpan& depth,
                                        double largest_side);

/// Thin sheet over a chain of points. Its normals point to the right of one who goes along the points, seen from +z.
surface::SurfaceMesh make_sheet_prism(const std::vector<PlanePoint>& chain, const DepthSpan& depth,
                                      double largest_side);

surface::SurfaceMesh make_ellipsoid(const Point& centre, const Point& half_axes, double largest_side);

/// Along the axes.
surface::SurfaceMesh make_box(const Point& low, const Point& high, double largest_side);

/// Thin parallelogram from a corner along two sides [m]; its normal is first x second.
surface::SurfaceMesh make_rectangle(const Point& corner, const Point& first_side, const Point& second_side,
                                    double largest_side);

/// Round tube between two points of its axis, closed by a flat lid at either end. The fluid is inside: normals point
/// there.
surface::SurfaceMesh make_tube(const Point& from, const Point& to, double radius, double largest_side);

/// Round about the line y = z = 0: the points of the outline hold the place along x and the distance from that line, 0
/// for the first and the last. x need not grow.
surface::SurfaceMesh make_revolved_body(const std::vector<PlanePoint>& outline, double largest_side);

/// Thin sheet of straight lines from points of one edge to those of the other, which are as many. Where both edges have
/// a point in common, the lines end in it. Its normal is the direction along the edges x that from the first to the
/// second.
surface::SurfaceMesh make_ruled_sheet(const std::vector<Point>& first_edge, const std::vector<Point>& second_edge,
                                      double largest_side);

}  // namespace couplet::flow
