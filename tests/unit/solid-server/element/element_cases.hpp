#pragma once
// Every element with every formulation and number of points that it has.

#include <ostream>

#include "solid-server/element/formulation.hpp"

namespace couplet::solid {

struct Case {
  const char* name;
  ElementShape shape;
  ElementFormulation formulation;
  int n_points;
};

inline std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}

constexpr Case cases[] = {
    {"hexahedron20_8", ElementShape::hexahedron20, ElementFormulation::standard, 8},
    {"hexahedron20_14", ElementShape::hexahedron20, ElementFormulation::standard, 14},
    {"hexahedron20_27", ElementShape::hexahedron20, ElementFormulation::standard, 27},
    {"hexahedron20_near_incompressible_8", ElementShape::hexahedron20, ElementFormulation::near_incompressible, 8},
    {"hexahedron20_near_incompressible_14", ElementShape::hexahedron20, ElementFormulation::near_incompressible, 14},
    {"hexahedron20_near_incompressible_27", ElementShape::hexahedron20, ElementFormulation::near_incompressible, 27},
    {"tetrahedron10", ElementShape::tetrahedron10, ElementFormulation::standard, 4},
    {"tetrahedron10_near_incompressible", ElementShape::tetrahedron10, ElementFormulation::near_incompressible, 4},
    {"hexahedron8_stabilised", ElementShape::hexahedron8, ElementFormulation::stabilised, 1},
    {"hexahedron8_8", ElementShape::hexahedron8, ElementFormulation::standard, 8},
};

}  // namespace couplet::solid
