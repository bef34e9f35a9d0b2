#pragma once
// What a scene need not say about contact: stiffness and largest depth, from the elements behind the surfaces.

#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/contact/surface_contact.hpp"

namespace couplet::solid {

/// The elements behind a surface.
struct Backing {
  double thickness = 0;  // of the thinnest: volume over area of the face (tetrahedra: three times that) [m]
  double stiffness = 0;  // M/h of the softest, M = K + 4/3 mu at rest without fibres, h its thickness [Pa/m]
};

/// `properties` of each block of the mesh.
Backing backing_of(const SolidMesh& mesh, const std::vector<BlockProperties>& properties,
                   const std::vector<ElementFace>& faces);

/// Where stiffness is 0: k = M/h of the softer surface, so that a pressure pushes surfaces into the contact distance by
/// as much as it compresses one layer of elements, and contact costs about as much of the stable step as an element.
/// Where largest_depth is 0: half the thickness of the thinnest element. Throws SceneError for unknown surfaces of pair
/// number `n`.
ContactPair complete(ContactPair pair, const SolidMesh& mesh, const std::vector<BlockProperties>& properties, int n);

}  // namespace couplet::solid
