#pragma once
// A pressure that stays normal to the deformed surface.

#include <functional>
#include <string>

#include "solid-server/element/face_packs.hpp"

namespace couplet::solid {

struct PressureLoad {
  std::string surface;
  std::function<double(double)> value;  // of the time [s]; positive pushes onto the body [Pa]
};

/// For the packs [first, last): the consistent nodal forces of a pressure on the deformed faces,
///   f_a = - p sum over points of N_a (x,xi x x,eta) w,  x = X + u   [N],
/// into `force`, where each face has its own place. Integrated exactly for the total force, so that a closed surface
/// feels none. `displacement` is a NodeVectors array [m].
void pressure_force(const FacePacks& faces, Index first, Index last, double pressure, const double* displacement,
                    StoredPack* force);

}  // namespace couplet::solid
