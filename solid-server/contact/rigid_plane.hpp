#pragma once
// A rigid, frictionless plane that the body cannot pass.

#include <functional>

#include "solid-server/element/face_packs.hpp"

namespace couplet::solid {

struct RigidPlane {
  double y = 0;          // the body stays below it [m]
  double stiffness = 0;  // k: pressure per depth beyond the plane [Pa/m]
};

/// The penalty k depth at the points of the faces. It is a potential over the area at rest, so that contact conserves
/// energy:
///   Pi = sum over points of k/2 depth^2 dA,  f_a = - k depth N_a dA along y,  depth = max(0, y - plane).
class PlaneContact {
 public:
  static constexpr int n_face_points = 9;

  PlaneContact(const SolidMesh& mesh, const std::vector<FaceNodes>& faces, std::vector<RigidPlane> planes);

  const FacePacks& faces() const { return faces_; }
  Index n_packs() const { return faces_.n_packs; }
  bool is_empty() const { return planes_.empty() || faces_.n_faces == 0; }

  /// For the packs [first, last): the forces [N] on the nodes of each face. `was_touching`, (n_packs), says which
  /// places in `force` are not zero; a pack that did not touch and does not touch costs only a look at its nodes.
  /// `displacement` is a NodeVectors array [m].
  void force(Index first, Index last, const double* displacement, StoredPack* force, char* was_touching) const;

  struct Total {
    double energy = 0;  // Pi [J]
    double force = 0;   // of the planes on the body, positive when they push it down [N]
  };
  Total total(const double* displacement) const;

  /// C_ab = - d f_a / d u_b = k N_a N_b dA along y, summed over the points beyond a plane, for pairs of nodes of a face.
  void stiffness(const double* displacement,
                 const std::function<void(Index node_a, Index node_b, const Eigen::Matrix3d& block)>& take) const;

  /// For each node, a bound on the sum of |d force_a / d y_b| over all b if the whole surface touched every plane
  /// [N/m].
  Eigen::VectorXd stiffness_bound(Index n_nodes) const;

 private:
  bool touches(const Pack (&y)[n_face_points]) const;

  FacePacks faces_;
  std::vector<RigidPlane> planes_;
  std::vector<StoredPack> area_;  // dA at rest [m^2], (n_packs, 9)
};

}  // namespace couplet::solid
