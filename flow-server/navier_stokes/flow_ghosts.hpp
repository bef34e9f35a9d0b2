#pragma once
// Ghosts of the flow: from neighbours and beyond borders, while the cells that need none are worked on.

#include <vector>

#include "flow-server/boundary/flow_border.hpp"
#include "flow-server/grid/flow_state.hpp"
#include "flow-server/grid/halo_exchange.hpp"
#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

class FlowGhosts {
 public:
  /// Block and border must outlive this.
  FlowGhosts(const FlowBlock& block, FlowBorder& border);

  /// Collective. The inner ghost layer of a velocity whose border values are set.
  void fill(VectorField& velocity);
  /// Collective. All layers that walls look at, of the same and of a change of it: those beyond borders next to
  /// neighbours too, where neighbours have them.
  void fill_deep(VectorField& velocity, VectorField* change = nullptr);
  /// Collective. Only what neighbours own.
  void fill_from_neighbours(VectorField& fields) { exchange_.exchange(pointers(fields), 1); }

  /// The exchange itself, for fields of the same shape.
  HaloExchange& exchange() { return exchange_; }

  /// Collective. The same of velocity and pressure of a state whose border values are those of its time.
  void fill(FlowState& state);

  /// Collective. Calls work(box) for boxes that together hold all cells and the faces around them once; those at the
  /// surface of the block after the ghosts have come.
  template <class Work>
  void while_filling(VectorField& velocity, bool needs_border_ghosts, const Work& work);

  const Traffic& traffic() const { return exchange_.traffic(); }

 private:
  std::vector<Field<double>*> pointers(VectorField& fields) const;

  const FlowBlock& block_;
  FlowBorder& border_;
  HaloExchange exchange_;
  bool has_borders_ = false;  // of the grid
  Box inner_;                 // cells whose stencils need no ghosts; empty where no other rank is waited for
};

template <class Work>
void FlowGhosts::while_filling(VectorField& velocity, bool needs_border_ghosts, const Work& work) {
  exchange_.start(pointers(velocity), 1);
  if (!inner_.is_empty()) work(inner_);
  exchange_.finish(pointers(velocity));
  if (needs_border_ghosts) border_.fill_velocity_ghosts(velocity);
  if (inner_.is_empty()) return work(block_.everything());
  Box rest = block_.everything();
  for (int d = 2; d >= 0; --d) {
    Box low = rest, high = rest;
    low.end[d] = inner_.begin[d];
    high.begin[d] = inner_.end[d];
    work(low);
    work(high);
    rest.begin[d] = inner_.begin[d], rest.end[d] = inner_.end[d];
  }
}

}  // namespace couplet::flow
