#include "flow-server/navier_stokes/body_placement.hpp"

#include <mpi.h>

#include <algorithm>
#include <limits>

#include "flow-server/immersed/edge_crossings.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

using report::text;

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

Extent extent_of(const BodySurface& surface, std::size_t d) {
  Extent extent;
  for (const Point& corner : surface.position) {
    extent.low = std::min(extent.low, corner[d]);
    extent.high = std::max(extent.high, corner[d]);
  }
  return extent;
}

struct Misplacement {
  std::string sentence, advice;
};

/// Of a body that cuts no edge of a cell.
Misplacement misplacement_of(const BodySurface& body, const StretchedGrid& grid) {
  bool is_around = true;
  double longest = 0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(grid.n_dimensions); ++d) {
    const StretchedAxis& axis = grid.axis[d];
    const Extent extent = extent_of(body, d);
    const std::string name(1, "xyz"[d]);
    if (!axis.is_periodic() && (extent.high < axis.start() || extent.low > axis.end()))
      return {"lies outside the grid: it reaches from " + name + " = " + text(extent.low) + " to " + text(extent.high) +
                  " m, the grid from " + text(axis.start()) + " to " + text(axis.end()) + " m",
              "move one of them"};
    is_around = is_around && extent.low <= axis.start() && extent.high >= axis.end();
    longest = std::max(longest, extent.high - extent.low);
  }
  if (is_around)
    return {"encloses the grid and cuts it nowhere",
            "take a smaller body or a larger grid; is a file in the right unit?"};
  return {"cuts no line between cells: it is at most " + text(longest) + " m long, a cell there " +
              text(cell_width_at(grid, body.position.front())) + " m wide",
          "take a larger body or smaller cells; is a file in the right unit?"};
}

}  // namespace

std::vector<std::string> check_placement(BodySurfaces& bodies, const StretchedGrid& grid,
                                         const BlockDecomposition& decomposition) {
  const std::vector<BodySurface> surfaces = bodies.at(0);
  std::vector<int> cuts(surfaces.size(), 0);
  if (decomposition.has_cells()) {
    EdgeCrossings crossings(grid, decomposition.mine(), 0);
    crossings.update(surfaces);
    for (const EdgeCrossings::Edge& edge : crossings.crossed())
      for (const EdgeCrossing& crossing : crossings.on_edge(edge.direction, edge.corner))
        cuts[static_cast<std::size_t>(crossing.surface)] = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, cuts.data(), static_cast<int>(cuts.size()), MPI_INT, MPI_MAX,
                decomposition.communicator());
  std::vector<std::string> notes;
  for (std::size_t b = 0; b < surfaces.size(); ++b) {
    if (cuts[b] != 0 || surfaces[b].position.empty()) continue;
    const Misplacement found = misplacement_of(surfaces[b], grid);
    const std::string name = "body '" + surfaces[b].name + "'";
    if (bodies.setup(static_cast<int>(b)).motion.is_fixed())
      throw report::SceneError(name, found.sentence, found.advice);
    notes.push_back(name + " at t = 0: " + found.sentence);
  }
  return notes;
}

}  // namespace couplet::flow
