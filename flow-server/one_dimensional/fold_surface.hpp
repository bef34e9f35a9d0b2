#pragma once
// The wetted surface of a fold, sorted for fast passes over its faces.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

/// One number for each of eight faces that are worked on abreast.
constexpr int n_lanes = 8;
using Lanes = Eigen::Array<double, n_lanes, 1>;

/// Eight faces. Parameter r of a face runs across the fold (in a plane z = constant), parameter s along its length.
/// Lanes beyond n_faces repeat the first face, so that every lane can be computed.
struct FaceBatch {
  std::array<std::array<std::int32_t, n_lanes>, 8> node;  // node[i][lane]: node i of the face, see quadratic_face.hpp
  std::array<std::int32_t, n_lanes> row;                  // which row along z the face belongs to
  int n_faces = 0;
};

/// A row of faces between two planes z = constant of the reference state.
struct FaceRow {
  double z_low = 0;   // [m]
  double z_high = 0;  // [m]
};

/// Positions of all nodes (n_nodes each) [m].
struct NodePositions {
  Eigen::ArrayXd x, y, z;
};

/// A surface of eight-node faces that is extruded along z in its reference state: each face has two straight edges
/// along z and two edges in planes z = constant; the rows that these planes make do not overlap. Deformed, it may have
/// any shape.
class FoldSurface {
 public:
  /// Throws PeerError naming the first face that is otherwise.
  explicit FoldSurface(const surface::SurfaceMesh& mesh);

  const std::vector<FaceBatch>& batches() const { return batches_; }
  const std::vector<FaceRow>& rows() const { return rows_; }  // rising in z
  const NodePositions& reference() const { return reference_; }
  std::int64_t n_nodes() const { return reference_.x.size(); }
  std::int64_t n_faces() const { return n_faces_; }

  /// reference position + displacement (n_nodes, 3).
  void move(const surface::NodeArray& displacement, NodePositions& moved) const;

 private:
  std::vector<FaceBatch> batches_;
  std::vector<FaceRow> rows_;
  NodePositions reference_;
  std::int64_t n_faces_ = 0;
};

}  // namespace couplet::flow
