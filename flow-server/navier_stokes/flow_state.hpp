#pragma once
// The flow at one time on the cells of one rank.

#include <array>
#include <cmath>
#include <limits>

#include "flow-server/grid/field.hpp"

namespace couplet::flow {

/// Two ghost layers in every direction of the flow. velocity[d] stands on the faces normal to direction d: entry (i, j,
/// k) is the face between the cell (i, j, k) and the next one in direction d.
struct FlowState {
  double time = 0;                                              // of the velocity [s]
  double pressure_time = 0;                                     // half a step behind it [s]
  double last_step = std::numeric_limits<double>::quiet_NaN();  // [s]; not a number: none was taken yet
  std::array<Field<double>, 3> velocity;                        // [m/s]
  Field<double> pressure;                                       // [Pa]
  std::array<Field<double>, 3> rate;  // du/dt by convection and diffusion one step before [m/s^2]; Adams-Bashforth only
};

}  // namespace couplet::flow
