#pragma once
// Which triangle lies beside which, where a surface ends, and which way it faces.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"

namespace couplet::flow {

/// A side of one triangle only, in the order in which that triangle goes round.
struct FreeEdge {
  int from;  // corner
  int to;    // corner
  int triangle;
};

/// A border of the grid, x, y or z = position. Where a surface ends on it, it neither has a hole nor a free edge: a
/// body in two dimensions is a prism without lids.
struct BorderPlane {
  int axis;         // 0, 1, 2
  double position;  // [m]
};

enum class FluidSide { outside, inside };  // of a closed surface: a body in the flow, or the wall of a vessel

struct SurfaceTopology {
  std::vector<FreeEdge> free_edge;            // without those on border planes
  std::vector<FreeEdge> border_edge;          // on border planes
  std::vector<BorderPlane> border_plane;      // those that the surface ends on
  std::vector<std::array<int, 3>> neighbour;  // (n_triangles): across the side from corner k to the next; -1: none
  std::vector<int> part;                      // (n_triangles): connected part, from 0
  int n_parts = 0;
  double volume = 0;  // that a closed surface encloses, negative where the fluid is inside; 0 for a sheet [m^3]
  std::vector<std::string> notes;  // a sentence for each repair, for the log
};

/// Finds how the triangles hang together and turns those that face the wrong way: in each connected part the fewer
/// follow the more; a closed part then faces the fluid, but for one inside the box of another (a cavity), which stays
/// as given. A million triangles take about half a second. Throws SceneError, naming positions, for a triangle without
/// area, a side with more than two triangles, a part with one side only (Moebius), and a closed surface with a hole.
SurfaceTopology orient_surface(BodySurface& surface, FluidSide fluid, std::span<const BorderPlane> planes);

/// Volume between a surface and the border planes that it ends on (all given) [m^3]: positive where the normals point
/// out.
double enclosed_volume(const BodySurface& surface, std::span<const BorderPlane> ended_on);

}  // namespace couplet::flow
