#pragma once
// What a block of elements is made of and how it is integrated.

#include "solid-server/element/formulation.hpp"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

struct BlockProperties {
  Material material;
  double density = 0;  // at rest [kg/m^3]
  int n_points = 8;    // quadrature points of an element: hexahedron20 8, 14 or 27; tetrahedron10 4; hexahedron8 1
  ElementFormulation formulation = ElementFormulation::standard;
};

}  // namespace couplet::solid
