#pragma once
// From faces of 3, 4, 6 or 8 nodes to triangles small enough for the grid, and forces back to the nodes.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::flow {

struct TessellationSize {
  double largest_side = 0;            // of a triangle, where the mesh lies at the start [m]; 0: no limit
  bool is_two_dimensional = false;    // sides are measured in x and y only; quadrilaterals are cut across z alone
  int largest_n_triangles = 8000000;  // more are refused
};

/// Triangles that follow the faces of a mesh, curved ones too. A corner is a weighted mean of the nodes of one face
/// (its shape functions); corners on the border of a face are shared with the next face, so that no gap opens when the
/// nodes move. Sides longer than the largest one are halved, in the parameters of their face, until none is left.
class SurfaceTessellation {
 public:
  /// Throws PeerError for a mesh that check_surface refuses or that has no faces, SceneError when more triangles were
  /// needed than are allowed.
  SurfaceTessellation(const surface::SurfaceMesh& mesh, const std::string& whose, const TessellationSize& size);

  int n_corners() const { return static_cast<int>(offset_.size()) - 1; }
  const std::vector<std::array<int, 3>>& triangle() const { return triangle_; }  // corners
  const std::vector<int>& face() const { return face_; }                         // (n_triangles): of the mesh

  /// (n_nodes, 3) to (n_corners): x_c = sum of w_cn x_n.
  void interpolate(const surface::NodeArray& nodal, std::vector<Point>& corner) const;

  /// The transpose, (n_corners) to (n_nodes, 3): f_n = sum of w_cn f_c. Sum and work of the forces are kept.
  void gather(std::span<const Point> corner_force, surface::NodeArray& nodal_force) const;

 private:
  using FacePoint = std::array<double, 2>;  // the two parameters of a face
  struct Piece {
    std::array<int, 3> corner;
    std::array<FacePoint, 3> at;
    int face;
  };

  void cut_into_pieces(const surface::SurfaceMesh& mesh, const TessellationSize& size);
  void cut_prism_face(const surface::SurfaceMesh& mesh, int face, const TessellationSize& size,
                      std::vector<int>& corner_of_node);
  void halve_long_sides(const surface::SurfaceMesh& mesh, const std::string& whose, const TessellationSize& size);
  int add_corner(const surface::SurfaceMesh& mesh, int face, const FacePoint& at);
  double squared_length(int a, int b, bool is_two_dimensional) const;

  std::vector<int> offset_{0};  // (n_corners + 1): corner c is made of node_[offset_[c] ... offset_[c + 1] - 1]
  std::vector<int> node_;
  std::vector<double> weight_;
  std::vector<Point> position_;  // while it is made [m]
  std::vector<Piece> piece_;     // while it is made
  std::vector<std::array<int, 3>> triangle_;
  std::vector<int> face_;
  std::int64_t n_nodes_;
};

}  // namespace couplet::flow
