#pragma once
// A rigid, frictionless plane that the body cannot pass.

#include <functional>
#include <string>

#include "solid-server/element/face_packs.hpp"

namespace couplet::solid {

struct RigidPlane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     // of the plane [m]
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitY();  // towards the side where bodies are; need not have length 1
  double stiffness = 0;                                // k: pressure per depth beyond the plane [Pa/m]
  std::vector<std::string> surfaces;                   // that may touch it; none: all wetted ones
};

/// The penalty k depth at the points of the faces. It is a potential over the area at rest, so that contact conserves
/// energy:
///   Pi = sum over points of k/2 depth^2 dA,  f_a = k depth N_a dA n,  depth = max(0, (point - x).n).
/// One plane and faces of one shape.
class PlaneContact {
 public:
  PlaneContact(const SolidMesh& mesh, const std::vector<FaceNodes>& faces, const RigidPlane& plane);

  const FacePacks& faces() const { return faces_; }
  Index n_packs() const { return faces_.n_packs; }

  /// For the packs [first, last): the forces [N] on the nodes of each face. `was_touching`, (n_packs), says which
  /// places in `force` are not zero; a pack that did not touch and does not touch costs only a look at its nodes.
  /// `displacement` is a NodeVectors array [m].
  void force(Index first, Index last, const double* displacement, StoredPack* force, char* was_touching) const;

  struct Total {
    double energy = 0;  // Pi [J]
    double force = 0;   // of the plane on the body along its normal [N]
  };
  Total total(const double* displacement) const;

  /// Calls visit(a, b, s) for every pair of nodes of every face that touches: the stiffness between nodes a and b is
  /// s n n^T, s = sum over touching points of k N_a N_b dA [N/m]. Exact.
  void stiffness(const double* displacement, const std::function<void(Index, Index, double)>& visit) const;
  const Eigen::Vector3d& normal() const { return normal_; }  // of length 1

  /// For each node, a bound on the sum of |d force_a / d x_b| over all b if all faces touched [N/m].
  Eigen::VectorXd stiffness_bound(Index n_nodes) const;

 private:
  template <int n_nodes, int n_points>
  void force_of(Index first, Index last, const double* displacement, StoredPack* force, char* was_touching) const;
  template <int n_nodes, int n_points>
  Total total_of(const double* displacement) const;

  FacePacks faces_;
  Eigen::Vector3d normal_;
  double offset_, stiffness_;     // normal.point [m], k [Pa/m]
  std::vector<StoredPack> area_;  // dA at rest [m^2], (n_packs, n_points)
};

}  // namespace couplet::solid
