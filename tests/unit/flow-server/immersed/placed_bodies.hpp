#pragma once
// Surfaces placed in a box, with given fields around them.

#include <mpi.h>

#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/immersed/body_geometry.hpp"
#include "flow-server/immersed/wall_forcing.hpp"
#include "flow-server/navier_stokes/flow_domain.hpp"

namespace couplet::flow {

/// Fluid of density 1 without viscosity between walls.
inline NavierStokesSetup quiet_setup(const StretchedGrid& grid) {
  return {grid, 1, 0, {}, {}, {}, {}, {}, TimeScheme::automatic, {}, {}, false};
}

struct PlacedBodies {
  explicit PlacedBodies(const StretchedGrid& grid, std::vector<BodySurface> surfaces,
                        MPI_Comm communicator = MPI_COMM_SELF, const Triple& shape = {1, 1, 1})
      : setup(quiet_setup(grid)),
        blocks(communicator,
               {equal_parts(grid.axis[0].n_cells(), shape[0], 1), equal_parts(grid.axis[1].n_cells(), shape[1], 1),
                equal_parts(grid.axis[2].n_cells(), shape[2], 1)},
               grid.is_periodic()),
        halo(blocks),
        border(setup.grid, blocks, {}, {}, false) {
    setup.bodies = [](double) { return std::vector<BodySurface>{}; };  // asks for the ghosts that bodies need
    block = make_flow_block(setup, blocks, border);
    bodies = std::make_unique<BodyGeometry>(block, BodyFlowSettings{});
    bodies->place(std::move(surfaces));
    velocity = block.new_vector_field();
    pressure = block.new_field();
  }

  /// Of all parts of cells, at the middles of the cells.
  void set_pressure(const std::function<double(const Point&)>& value) {
    const Triple& ghosts = block.ghosts;
    const Box all = box_of(block.sizes).grown(ghosts);
    visit(all, [&](const Triple& cell) { pressure(cell[0], cell[1], cell[2]) = value(centre_of_cell(block, cell)); });
    const CutCells& cut = bodies->cut();
    for (std::size_t f = 0; f < cut.further_parts().size(); ++f) {
      const CellPart& part = cut.parts()[static_cast<std::size_t>(cut.further_parts()[f])];
      bodies->piece_pressure[f] = value(centre_of_cell(block, cut.cells()[static_cast<std::size_t>(part.cell)].cell));
    }
  }
  /// On all faces but those inside bodies, which are no numbers.
  void set_velocity(const std::function<double(const Point&, int component)>& value) {
    for (int d = 0; d < block.n_dimensions; ++d)
      visit(box_of(block.sizes).grown(block.ghosts), [&](const Triple& face) {
        velocity[d](face[0], face[1], face[2]) = bodies->cut().is_face_solid(d, face)
                                                     ? std::numeric_limits<double>::quiet_NaN()
                                                     : value(centre_of_face(block, d, face), d);
      });
  }
  /// What WallForcing asks for: what neighbours own. Beyond borders the given values stay.
  FillGhosts fill_from_neighbours() {
    return [this](VectorField& filled, VectorField* change) {
      std::vector<Field<double>*> fields;
      for (VectorField* vectors : {&filled, change})
        for (int d = 0; vectors && d < block.n_dimensions; ++d) fields.push_back(&(*vectors)[d]);
      halo.exchange(fields, axis_margin);
    };
  }
  template <class Visit>
  static void visit(const Box& box, const Visit& visit) {
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) visit(Triple{i, j, k});
  }

  NavierStokesSetup setup;
  BlockDecomposition blocks;
  HaloExchange halo;
  FlowBorder border;
  FlowBlock block;
  std::unique_ptr<BodyGeometry> bodies;
  VectorField velocity;
  Field<double> pressure;
};

}  // namespace couplet::flow
