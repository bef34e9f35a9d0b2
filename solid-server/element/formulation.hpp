#pragma once
// How an element turns displacements into strains.

namespace couplet::solid {

enum class ElementFormulation {
  standard,             // F from the displacements at every point
  near_incompressible,  // the volume ratio J is replaced by its projection onto the linear functions of the element
  stabilised,           // 8-node hexahedra: F at the centre, bending and twisting by stabilisation
};

}  // namespace couplet::solid
