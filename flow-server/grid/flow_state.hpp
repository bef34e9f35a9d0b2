#pragma once
// The flow at one time on the cells of one rank.

#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "flow-server/grid/field.hpp"

namespace couplet::flow {

class BodyGeometry;

/// What FlowState::rate holds of the step before.
enum class RateKind {
  none,               // nothing: no step was taken, or by a scheme that needs no memory
  of_momentum,        // du/dt by convection and diffusion at its start: for Adams-Bashforth
  mean_acceleration,  // change of velocity over its length: for Crank-Nicolson
};

/// Two ghost layers in every direction of the flow, of which the inner one is filled. velocity[d] stands on the faces
/// normal to direction d: entry (i, j, k) is the face between the cell (i, j, k) and the next one in direction d. In
/// two dimensions the fields of the third direction are empty.
struct FlowState {
  double time = 0;                                              // of the velocity [s]
  double pressure_time = 0;                                     // half a step behind it [s]
  double last_step = std::numeric_limits<double>::quiet_NaN();  // [s]; not a number: none was taken yet
  VectorField velocity;                                         // [m/s]
  Field<double> pressure;                                       // [Pa]
  double courant_rate = 0;   // largest sum of |u| / dx of the velocity on all ranks [1/s]
  double largest_speed = 0;  // of the velocity on all ranks [m/s]
  RateKind rate_kind = RateKind::none;
  VectorField rate;                      // [m/s^2]; empty where the scheme needs none
  std::shared_ptr<BodyGeometry> bodies;  // where there are bodies: their place, and the pressure of cut cells
};

}  // namespace couplet::flow
