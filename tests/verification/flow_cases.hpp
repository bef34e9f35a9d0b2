#pragma once
// Set-ups and norms shared by the verifications of the flow.

#include <mpi.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "flow-server/navier_stokes/fractional_step.hpp"

namespace couplet::flow {

/// One part in each direction as `shape` says; widths of the parts differ where a number of cells is no multiple.
inline BlockDecomposition decompose(const StretchedGrid& grid, const Triple& shape,
                                    MPI_Comm communicator = MPI_COMM_WORLD) {
  std::array<Partition, 3> parts;
  for (int d = 0; d < 3; ++d) parts[d] = equal_parts(grid.axis[d].n_cells(), shape[d], 1);
  return BlockDecomposition(communicator, parts, grid.is_periodic());
}
inline BlockDecomposition decompose(const StretchedGrid& grid) {
  int n_ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  return decompose(grid, choose_shape(grid.n_cells(), n_ranks));
}

inline StretchedGrid box_grid(const std::array<std::vector<double>, 3>& faces, const std::array<bool, 3>& is_periodic,
                              int n_dimensions = 3) {
  return {{StretchedAxis(faces[0], is_periodic[0]), StretchedAxis(faces[1], is_periodic[1]),
           StretchedAxis(faces[2], is_periodic[2])},
          n_dimensions};
}

/// Fluid of density 1 without viscosity, borders that are walls, solved almost to round-off.
inline NavierStokesSetup setup_on(StretchedGrid grid, TimeScheme scheme) {
  NavierStokesSetup setup{std::move(grid), 1, 0, {}, {}, {}, {}, {}, scheme, {}, {}, false};
  setup.pressure.relative_tolerance = 1e-8;
  setup.pressure.divergence_tolerance = 1e-12;
  return setup;
}

struct Norms {
  double rms = 0, largest = 0;
};

inline double summed(double mine) {
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return mine;
}

/// Of field - exact over all cells (component -1: at centres, else at the faces of that direction).
inline Norms error_of(const FractionalStep& flow, const Field<double>& field, int component,
                      const std::function<double(const Point&)>& exact, bool ignores_mean = false) {
  const StretchedGrid& grid = flow.setup().grid;
  const Triple& origin = flow.decomposition().mine().begin;
  const Box box = box_of(flow.decomposition().mine().sizes());
  const auto visit = [&](const auto& with) {
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const Triple cell{i, j, k};
          Point place;
          double volume = 1;
          for (int d = 0; d < 3; ++d) {
            const int global = origin[d] + cell[d];
            place[d] = d == component ? grid.axis[d].face(global + 1) : grid.axis[d].centre(global);
            volume *= grid.axis[d].width(global);
          }
          with(field(i, j, k) - exact(place), volume);
        }
  };
  double sum = 0, volumes = 0;
  visit([&](double error, double volume) { sum += volume * error, volumes += volume; });
  volumes = summed(volumes);
  const double mean = ignores_mean ? summed(sum) / volumes : 0;
  double squares = 0, largest = 0;
  visit([&](double error, double volume) {
    squares += volume * (error - mean) * (error - mean);
    largest = std::max(largest, std::abs(error - mean));
  });
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  return {std::sqrt(summed(squares) / volumes), largest};
}

/// Sum of u^2 / 2 times the volume around each face.
inline double kinetic_energy(const FractionalStep& flow, const FlowState& state) {
  const StretchedGrid& grid = flow.setup().grid;
  const Box mine = flow.decomposition().mine();
  double energy = 0;
  for (int c = 0; c < grid.n_dimensions; ++c)
    for (int k = 0; k < mine.size(2); ++k)
      for (int j = 0; j < mine.size(1); ++j)
        for (int i = 0; i < mine.size(0); ++i) {
          const Triple cell{i, j, k};
          double volume = 1;
          for (int d = 0; d < 3; ++d) {
            const int global = mine.begin[d] + cell[d];
            volume *= d == c ? grid.axis[d].distance(global) : grid.axis[d].width(global);
          }
          energy += 0.5 * volume * state.velocity[c](i, j, k) * state.velocity[c](i, j, k);
        }
  return summed(energy);
}

inline double order_between(double coarse, double fine, double ratio = 2) {
  return std::log(coarse / fine) / std::log(ratio);
}

}  // namespace couplet::flow
