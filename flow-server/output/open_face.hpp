#pragma once
// What bodies leave open of a face.

#include "flow-server/grid/field.hpp"

namespace couplet::flow {

class BodyGeometry;

/// Mean over the face (c, local indices) of the velocity along c, 0 inside bodies: its flow over its area. `bodies`:
/// null where there are none.
double open_velocity(const BodyGeometry* bodies, const Field<double>& velocity, int c, const Triple& face);

/// The share of the face that is fluid.
double open_share(const BodyGeometry* bodies, int c, const Triple& face);

}  // namespace couplet::flow
