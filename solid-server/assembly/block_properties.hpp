#pragma once
// What a block of elements is made of and how it is integrated.

#include "solid-server/element/formulation.hpp"
#include "solid-server/material/material.hpp"

namespace couplet::solid {

struct BlockProperties {
  Material material;
  double density = 0;  // at rest [kg/m^3]
  int n_points = 8;    // quadrature points of an element: default_n_points (element/formulation.hpp)
  ElementFormulation formulation = ElementFormulation::standard;
};

}  // namespace couplet::solid
