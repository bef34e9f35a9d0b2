#pragma once
// The point of a curved face that is closest to a given point.

#include <limits>

#include "solid-server/contact/curved_face.hpp"

namespace couplet::solid {

struct ClosestPoint {
  FaceCoordinates at = {0, 0};
  NodeQuad position{};  // p [m]
  double distance = 0;  // |x - p| [m], never negative
  int edge = -1;        // the edge on which it lies, or -1 inside the face
  int corner = -1;      // the corner in which it lies, or -1
};

/// The minimum of |x - p(xi, eta)| over the face. Newton with step halving from the middle of the face, on the face
/// carried on by an eighth of its width beyond its edges (Gauss-Newton where the Hessian is not positive); when the
/// minimum is not inside, the closest of the points on its edges, by safeguarded Newton along each. Converged to
/// round-off. For a face that is curved so much, or a point so far away, that there are several local minima, the one
/// downhill from the middle counts. If the face is not closer than `within` [m], only a distance above it comes back.
ClosestPoint closest_point(const CurvedFace& face, const NodeQuad& x,
                           double within = std::numeric_limits<double>::infinity());

}  // namespace couplet::solid
