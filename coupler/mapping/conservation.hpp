#pragma once
// What one exchange of forces kept.

#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

/// Each number is relative to the sum of the magnitudes that it is made of, so that round-off shows as about 1e-16 even
/// where the sum itself vanishes.
struct ConservationError {
  double force = 0;  // |sum f_flow - sum f_solid| / sum |f|
  double moment =
      0;  // |sum r x f_flow - sum r x f_solid| / sum |r||f|, r from the centre of the flow's surface as it is now
  double work = 0;  // |sum f_flow . v_flow - sum f_solid . v_solid| / sum |f||v|
};

/// One side of the interface. All fields are (n_nodes, 3); others than that are not counted: a force of another kind
/// has no error, a missing position no moment, a missing motion no work.
struct InterfaceSide {
  const surface::NodeArray& force;
  const surface::NodeArray& reference;     // position [m]
  const surface::NodeArray& displacement;  // [m]
  const surface::NodeArray& motion;        // velocity, or any virtual motion
};

/// One pass over each side: 1e5 nodes take about a millisecond.
ConservationError compare_sides(const InterfaceSide& flow, const InterfaceSide& solid);

}  // namespace couplet::coupling
