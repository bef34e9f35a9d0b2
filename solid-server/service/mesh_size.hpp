#pragma once
// How many elements a scene asks for, before any is made.

#include "couplet/v1/solid.pb.h"

namespace couplet::solid {

/// Of a body with a parametric mesh; 0 for mesh files, whose size is known when they are read.
double n_elements_wanted(const v1::Body& body);

/// Throws SceneError, naming the largest body, when the elements of all bodies cannot be numbered or need more memory
/// than `memory` [bytes], that of this machine.
void refuse_too_many_elements(const v1::Solid& solid, double memory);

}  // namespace couplet::solid
