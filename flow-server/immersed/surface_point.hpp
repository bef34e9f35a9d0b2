#pragma once
// A point of a surface that carries what the flow wants to know of the wall there.

#include <Eigen/Core>

namespace couplet::flow {

struct SurfacePoint {
  int surface = 0;           // index among the bodies
  int triangle = 0;          // of that surface
  Eigen::Vector3d weight;    // of the three corners of the triangle
  double opening = 0;        // of the surface there
  Eigen::Vector3d velocity;  // of the surface there [m/s]
};

}  // namespace couplet::flow
