#pragma once
// Faces of eight nodes, eight to a pack: what pressure and contact read in every substep.

#include "solid-server/element/element_packs.hpp"

namespace couplet::solid {

constexpr int n_face_points = 9;

/// Packs of force that one pack of faces writes: (8 nodes, 4).
constexpr Index packs_per_face_pack = 4 * hex20::n_face_nodes;

/// The last pack is filled up with copies of the last face, whose forces nobody reads.
struct FacePacks {
  Index n_faces = 0, n_packs = 0;
  std::vector<Index> node_start;     // first entry of each node in a NodeVectors array, (n_packs, 8, 8 lanes)
  std::vector<StoredPack> position;  // at rest [m], (n_packs, 8, 3)
  double shape[n_face_points][hex20::n_face_nodes];        // N_a at the points
  double gradient[n_face_points][hex20::n_face_nodes][2];  // dN_a/dxi_k
  double weight[n_face_points];
};

FacePacks make_face_packs(const SolidMesh& mesh, const std::vector<FaceNodes>& faces);

/// Start of the force (x, y, z, 0) on a local node of a face in the buffer, counted in doubles.
Index face_force_start(Index face, int local_node);

}  // namespace couplet::solid
