#pragma once
// Faces of one shape, eight to a pack: what pressure and contact read in every substep.

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

/// The last pack is filled up with copies of the last face, whose forces nobody reads.
struct FacePacks {
  int n_nodes = 0, n_points = 0;  // of a face
  Index n_faces = 0, n_packs = 0;
  std::vector<Index> node_start;     // first entry of each node in a NodeVectors array, (n_packs, n_nodes, 8 lanes)
  std::vector<StoredPack> position;  // at rest [m], (n_packs, n_nodes, 3)
  double shape[max_face_points][max_face_nodes];        // N_a at the points
  double gradient[max_face_points][max_face_nodes][2];  // dN_a/dxi_k
  double weight[max_face_points];

  /// Packs of force that one pack of faces writes: (n_nodes, 4).
  Index packs_of_force() const { return 4 * n_nodes; }
};

/// The faces must be of one shape.
FacePacks make_face_packs(const SolidMesh& mesh, const std::vector<FaceNodes>& faces);

/// The faces of each shape that occurs, in the given order.
std::vector<std::vector<FaceNodes>> group_by_shape(const std::vector<FaceNodes>& faces);

/// Calls kernel.template operator()<n_nodes, n_points>() for the shape of the faces.
template <class Kernel>
auto with_face_shape(const FacePacks& faces, const Kernel& kernel) {
  if (faces.n_nodes == 8) return kernel.template operator()<8, 9>();
  if (faces.n_nodes == 4) return kernel.template operator()<4, 9>();
  return kernel.template operator()<6, 7>();
}

/// Start of the force (x, y, z, 0) on a local node of a face in the buffer, counted in doubles.
Index face_force_start(const FacePacks& packs, Index face, int local_node);

}  // namespace couplet::solid
