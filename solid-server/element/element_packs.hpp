#pragma once
// The elements of a block, eight to a pack: what the internal-force kernel reads in every substep.

#include "solid-server/element/formulation.hpp"
#include "solid-server/element/quadrature.hpp"
#include "solid-server/material/pack.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Node quantities inside the time loop: x, y, z and a zero, so that a node is one aligned load.
using NodeVectors = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// A layer of the block begins with a new pack; a pack that is not full is filled up with copies of its last element,
/// whose forces nobody reads. Layers of the same shape share one geometry, which then stays in the cache of the
/// processor.
///
/// The geometry of a pack: standard formulation: dxi_k/dX_J (k, J) [1/m] and volume [m^3], (n_points, 10);
/// near-incompressible: then the inverse Gram matrix of volume_projection.hpp; stabilised: stabilisation.hpp.
struct ElementPacks {
  ElementShape shape = ElementShape::hexahedron20;
  ElementFormulation formulation = ElementFormulation::standard;
  int n_nodes = 0, n_points = 0;
  Index n_elements = 0, n_packs = 0;
  std::vector<double> natural_gradient;  // dN_a/dxi_k at the points, (n_points, n_nodes, 3)
  std::vector<Index> lane_element;       // the element of the mesh in each lane, -1 in a copy, (n_packs, 8)
  std::vector<Index> node_start;         // first entry of each node in a NodeVectors array, (n_packs, n_nodes, 8 lanes)
  std::vector<double> volume_function;   // of the near-incompressible formulation, (n_points, n_volume_functions)
  std::vector<Index> geometry_start;     // of each pack in `geometry`, (n_packs)
  std::vector<StoredPack> geometry;      // (packs of different shape, numbers of a pack)
  std::vector<StoredPack> axes;          // material axes at rest, (n_packs, 2, 3); empty: the block has none

  /// Packs of force that one pack of elements writes: (n_nodes, 4).
  Index packs_of_force() const { return 4 * n_nodes; }
};

/// Throws SceneError naming the element when an element is folded at a quadrature point (its volume there is not above
/// 0; with the stabilised formulation at one of 2 x 2 x 2 points).
ElementPacks make_element_packs(const SolidMesh& mesh, const ElementBlock& block, int n_points,
                                ElementFormulation formulation = ElementFormulation::standard);

}  // namespace couplet::solid
