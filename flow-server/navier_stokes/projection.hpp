#pragma once
// The step from a velocity with divergence to one without, and what is measured on the way.

#include <array>

#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

/// Of one rank, or of all after reduce().
struct FlowMeasure {
  double courant_rate = 0;    // largest sum of |u| / dx [1/s]
  double speed = 0;           // largest [m/s]
  double divergence = 0;      // largest |div u| [1/s]
  double divergence_sum = 0;  // of volume (div u)^2 [m^3/s^2]
  double volume = 0;          // of the fluid [m^3]
  double leaving = 0;         // number of a body, from 1, that moves through an open border; 0: none does

  double divergence_rms() const;
};

/// source = factor * div velocity in the cells of `part`; reads the faces at the start of each cell.
void take_divergence(const FlowBlock& block, const Box& part, double factor, const VectorField& velocity,
                     Field<double>& source);

/// velocity -= factor * grad phi on all faces of unknown velocity, those at the start of the block included;
/// new_pressure = pressure + phi - viscous_factor * source. One pass; measures the corrected velocity.
/// `measured`: cells in which that is done.
FlowMeasure correct(const FlowBlock& block, const ActiveCells& measured, double factor, const Field<double>& phi,
                    double viscous_factor, const Field<double>& source, const Field<double>& pressure,
                    Field<double>& new_pressure, VectorField& velocity);

/// The same measures of any velocity; needs the faces at the start of the block.
FlowMeasure measure(const FlowBlock& block, const ActiveCells& measured, const VectorField& velocity);

/// Collective: the measure of all ranks.
FlowMeasure reduce(const FlowMeasure& mine, MPI_Comm communicator);

}  // namespace couplet::flow
