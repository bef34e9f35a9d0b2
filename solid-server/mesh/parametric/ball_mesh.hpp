#pragma once
// A solid ball, or a part of it.

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

enum class BallPart { whole, lower_half, upper_half };

struct BallShape {
  double radius = 10e-3;                             // [m]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // [m]
  BallPart part = BallPart::whole;                   // halves along y
  bool is_quarter = false;  // keep only x and z above the centre's: symmetric to the planes x_min and z_min
  int n_elements = 4;       // along half an edge of the inner cube, and from its faces to the sphere
};

/// A rounded cube in the middle and a shell on each of its faces, divided evenly by angle, so that no element is
/// folded. Nodes of the surface, midside nodes too, stand on the sphere. Surfaces: surface (the sphere), for halves cut
/// (the plane through the centre), for quarters x_min and z_min. Throws SceneError for a radius or count that is not
/// above 0.
SolidMesh make_ball_mesh(const BallShape& shape);

}  // namespace couplet::solid
