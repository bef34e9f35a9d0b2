#pragma once
// Convection, diffusion and the pressure gradient of all components in one pass over the cells.

#include <array>

#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

/// new = old + now * rate(old) + before * rate_before - pressure * grad p + impulse
struct MomentumWeights {
  double now = 0;                   // [s]
  double before = 0;                // [s]
  double pressure = 0;              // step over density [s m^3/kg]
  std::array<double, 3> impulse{};  // [m/s]
  double viscosity = 0;             // kinematic [m^2/s]
};

/// Second-order central differences in flux form that conserve momentum, and kinetic energy where div u = 0
/// [Verstappen and Veldman, J. Comput. Phys. 187 (2003) 343-368]. Reads one ghost layer of velocity and the pressure
/// next to each face. `carrier` convects, it may be the velocity itself. Writes the faces of `part` that this rank
/// computes, out of place. `rate_before`: not read where weights.before is 0; `rate`: where not null the rate of old
/// [m/s^2] is stored, may be the same fields as rate_before.
void advance_momentum(const FlowBlock& block, const Box& part, const MomentumWeights& weights,
                      const VectorField& carrier, const VectorField& velocity, const Field<double>& pressure,
                      const VectorField* rate_before, VectorField* rate, VectorField& new_velocity);

}  // namespace couplet::flow
