#include "flow-server/navier_stokes/flow_failure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

using report::text;

std::string place_of(const FlowBlock& block, const Triple& cell) {
  std::string place = "cell (";
  for (int d = 0; d < 3; ++d) place += std::to_string(cell[d]) + (d < 2 ? ", " : ") at (");
  for (int d = 0; d < 3; ++d) place += text(block.grid->axis[d].centre(cell[d])) + (d < 2 ? ", " : ") m");
  return place;
}

}  // namespace

void require_finite(const FlowBlock& block, const VectorField& velocity, double time) {
  const Triple n_cells = block.grid->n_cells(), origin = block.decomposition->mine().begin;
  const long none = std::numeric_limits<long>::max();
  long first = none;
  for (int d = 0; d < block.n_dimensions; ++d) {
    const Box faces = block.computed_faces(d);
    for (int k = faces.begin[2]; k < faces.end[2]; ++k)
      for (int j = faces.begin[1]; j < faces.end[1]; ++j)
        for (int i = faces.begin[0]; i < faces.end[0]; ++i) {
          if (std::isfinite(velocity[d](i, j, k))) continue;
          const Triple cell{std::max(i, 0), std::max(j, 0), std::max(k, 0)};  // beside a face of the border
          const long number = origin[0] + cell[0] +
                              static_cast<long>(n_cells[0]) *
                                  (origin[1] + cell[1] + static_cast<long>(n_cells[1]) * (origin[2] + cell[2]));
          first = std::min(first, number);
        }
  }
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_LONG, MPI_MIN, block.decomposition->communicator());
  if (first == none) return;
  const long row = first / n_cells[0];
  const Triple cell{static_cast<int>(first % n_cells[0]), static_cast<int>(row % n_cells[1]),
                    static_cast<int>(row / n_cells[1])};
  throw report::NumericsError(place_of(block, cell), "the velocity at t = " + text(time) + " s is not a number",
                              "look for values that are not numbers in borders and forces, or take smaller steps");
}

void refuse_step(const FlowBlock& block, const FlowState& state, bool is_by_diffusion, double step, double smallest) {
  if (is_by_diffusion)
    throw report::NumericsError("time step",
                                "at t = " + text(state.time) + " s diffusion asks for steps of " + text(step) +
                                    " s, less than the smallest allowed, " + text(smallest) + " s",
                                "use Crank-Nicolson, allow smaller steps or make the cells larger");
  struct {
    double rate;
    int rank;
  } worst{0, block.decomposition->rank()};
  Triple cell{};
  std::array<double, 2> speed_and_cell{};
  for (int k = 0; k < block.sizes[2]; ++k)
    for (int j = 0; j < block.sizes[1]; ++j)
      for (int i = 0; i < block.sizes[0]; ++i) {
        double demand = 0, square = 0;
        for (int d = 0; d < block.n_dimensions; ++d) {
          Triple before{i, j, k};
          --before[d];
          const double here = std::max(std::abs(state.velocity[d](i, j, k)),
                                       std::abs(state.velocity[d](before[0], before[1], before[2])));
          demand += here * block.axis[d].inverse_width[Triple{i, j, k}[d]];
          square += here * here;
        }
        if (demand < worst.rate) continue;
        worst.rate = demand;
        cell = {i, j, k};
        speed_and_cell[0] = std::sqrt(square);
      }
  for (int d = 0; d < 3; ++d) cell[d] += block.decomposition->mine().begin[d];
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, block.decomposition->communicator());
  MPI_Bcast(cell.data(), 3, MPI_INT, worst.rank, block.decomposition->communicator());
  MPI_Bcast(speed_and_cell.data(), 1, MPI_DOUBLE, worst.rank, block.decomposition->communicator());
  throw report::NumericsError(place_of(block, cell),
                              "at t = " + text(state.time) + " s a speed of " + text(speed_and_cell[0]) +
                                  " m/s asks for steps of " + text(step) + " s, less than the smallest allowed, " +
                                  text(smallest) + " s",
                              "look at the flow there; allow smaller steps or make the cells larger");
}

void refuse_leaving_body(const StretchedGrid& grid, const BodySurface& body, double time) {
  double nearest = std::numeric_limits<double>::infinity();
  std::string border, reached;
  for (int d = 0; d < grid.n_dimensions; ++d) {
    const StretchedAxis& axis = grid.axis[d];
    const auto at = static_cast<std::size_t>(d);
    if (axis.is_periodic()) continue;
    for (const int side : {0, 1}) {
      const double place = side == 0 ? axis.start() : axis.end();
      double gap = std::numeric_limits<double>::infinity();  // negative beyond the border
      for (const Point& corner : body.position)
        gap = std::min(gap, side == 0 ? corner[at] - place : place - corner[at]);
      if (gap >= nearest) continue;
      nearest = gap;
      const std::string name(1, "xyz"[at]);
      border = name + (side == 0 ? " start at " : " end at ") + name + " = " + text(place) + " m";
      reached = name + " = " + text(side == 0 ? place + gap : place - gap) + " m";
    }
  }
  throw report::NumericsError("body '" + body.name + "' at t = " + text(time) + " s",
                              "moves through an open border of the grid, " + border + ": it reaches to " + reached,
                              "end the run before, or give it a longer grid");
}

}  // namespace couplet::flow
