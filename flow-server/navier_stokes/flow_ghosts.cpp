#include "flow-server/navier_stokes/flow_ghosts.hpp"

namespace couplet::flow {

namespace {

bool has_other_ranks_beside(const BlockDecomposition& blocks) {
  for (int n = 0; n < 27; ++n) {
    const int rank = blocks.neighbour({n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1});
    if (rank != MPI_PROC_NULL && rank != blocks.rank()) return true;
  }
  return false;
}

}  // namespace

FlowGhosts::FlowGhosts(const FlowBlock& block, FlowBorder& border)
    : block_(block), border_(border), exchange_(*block.decomposition) {
  for (int d = 0; d < block.n_dimensions; ++d) has_borders_ |= !block.decomposition->is_periodic()[d];
  if (!has_other_ranks_beside(*block.decomposition)) return;
  inner_ = box_of(block.sizes);
  for (int d = 0; d < block.n_dimensions; ++d) ++inner_.begin[d], --inner_.end[d];
  if (inner_.is_empty()) inner_ = {};
}

void FlowGhosts::fill(VectorField& velocity) {
  exchange_.exchange(pointers(velocity), 1);
  border_.fill_velocity_ghosts(velocity);
}

void FlowGhosts::fill_deep(VectorField& velocity, VectorField* change) {
  std::vector<Field<double>*> fields = pointers(velocity);
  if (change)
    for (Field<double>* field : pointers(*change)) fields.push_back(field);
  if (has_borders_) {
    exchange_.exchange(fields, 1);
    border_.fill_velocity_ghosts(velocity);
    if (change) border_.fill_change_ghosts(velocity, *change);
  }
  exchange_.exchange(fields, axis_margin);
}

void FlowGhosts::fill(FlowState& state) {
  std::vector<Field<double>*> fields = pointers(state.velocity);
  fields.push_back(&state.pressure);
  const int depth = state.bodies ? axis_margin : 1;
  exchange_.exchange(fields, depth);
  border_.begin_step(state.velocity);
  border_.fill_velocity_ghosts(state.velocity);
  border_.fill_pressure_ghosts(state.pressure);
  // Edges between a border and a neighbour: the neighbour has them now. Only what is measured near walls asks for them.
  if (has_borders_) exchange_.exchange(fields, depth);
}

std::vector<Field<double>*> FlowGhosts::pointers(VectorField& fields) const {
  std::vector<Field<double>*> result;
  for (int d = 0; d < block_.n_dimensions; ++d) result.push_back(&fields[d]);
  return result;
}

}  // namespace couplet::flow
