#pragma once
// The interface between flow and solid as C++ values.

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace couplet::surface {

/// One row a node, one column a component.
using NodeArray = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using IndexArray = Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>;

/// A surface in its reference position. Faces have 3 (triangle), 4 (quadrilateral), 6 (quadratic triangle) or 8 nodes
/// (quadratic quadrilateral: four corners, then the midside nodes between corners 0-1, 1-2, 2-3, 3-0). The right-hand
/// normal of a face points from the solid into the fluid. A surface may have nodes only (no faces).
struct SurfaceMesh {
  NodeArray node_position;          // (n_nodes, 3) [m]
  IndexArray face_offset;           // (n_faces + 1): face f has nodes face_node[face_offset[f] ... face_offset[f+1]-1]
  IndexArray face_node;             // (sum of nodes per face)
  IndexArray face_region;           // (n_faces): index into region
  std::vector<std::string> region;  // names, for example inferior, medial, superior
  std::map<std::string, std::int64_t> marker;  // named nodes

  std::int64_t n_nodes() const { return node_position.rows(); }
  std::int64_t n_faces() const { return face_offset.size() > 0 ? face_offset.size() - 1 : 0; }
};

/// Throws PeerError naming what is wrong: sizes that disagree, indices out of range, a face with a count of nodes that
/// is not 3, 4, 6 or 8, positions that are not finite.
void check_surface(const SurfaceMesh& mesh, const std::string& whose);

}  // namespace couplet::surface
