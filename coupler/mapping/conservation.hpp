#pragma once
// What one exchange of forces kept.

#include "proto/surface/surface_mesh.hpp"

namespace couplet::coupling {

/// Each number is relative to the sum of the magnitudes that it is made of, so that round-off shows as about 1e-16 even
/// where the sum itself vanishes.
struct ConservationError {
  double force = 0;  // |sum f_flow - sum f_solid| / sum |f|
  double moment =
      0;            // |sum r x f_flow - sum r x f_solid| / sum |r||f|, r from the centre of the surface, both deformed
  double work = 0;  // |f_flow . v_flow - f_solid . v_solid| / sum |f||v|
};

/// One side of the interface, each (n_nodes, 3); position or motion may be empty: its error is then 0. Forces of
/// another number of components have no moment.
struct InterfaceSide {
  const surface::NodeArray& force;
  const surface::NodeArray& position;  // present [m]
  const surface::NodeArray& motion;    // velocity, or any virtual motion
};

ConservationError compare_sides(const InterfaceSide& flow, const InterfaceSide& solid);

}  // namespace couplet::coupling
