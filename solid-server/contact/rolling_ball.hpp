#pragma once
// The distance from a surface of faces whose valleys are filled by a ball that rolls over them.

#include <algorithm>
#include <span>
#include <vector>

#include "solid-server/contact/curved_face.hpp"

namespace couplet::solid {

/// Where the ball touches one of the faces.
struct BallTouch {
  std::size_t face = 0;  // of those handed over
  FaceCoordinates at = {0, 0};
  NodeQuad direction{};  // from the face to the middle of the ball, a unit vector n_f
  double distance = 0;   // from the face to the middle of the ball [m]
  double height = 0;     // of x over the plane through `at` across the direction, h_f [m]
  double share = 0;      // lambda_f
};

struct RoundedDistance {
  double distance = 0;           // D [m]
  NodeQuad direction{};          // dD/dx = sum of lambda_f n_f; in a valley shorter than 1
  std::vector<BallTouch> touch;  // one, or in a valley several
  double to_faces = 0;           // from the middle of the ball to the closest face [m]
};

/// The distance d(x) from faces that meet at an angle has a kink above a valley between them, where two of them are
/// equally close: a force along its gradient jumps there, and a point that is pressed into the valley finds its
/// equilibrium in the jump, where Newton's method finds nothing. In its place stands the Moreau envelope [Moreau 1965]
///   D(x) = max over y of ( d(y) - |x - y|^2 / (2 rho) ) - rho/2,
/// which is d(x) itself but where a ball of radius d(y) around y = x + rho dD/dx touches several faces: valleys are
/// rounded, by at most rho (1 - cos theta) for faces that are bent against each other by 2 theta, within about rho
/// theta of the edge; ridges and flush faces are left as they are. The gradient of D is continuous, and as D is
/// extremal in y its derivatives by the positions of the faces are those of d(y) alone: a force along the gradient
/// conserves momentum, angular momentum and energy.
///
/// y is found by fixed points: the faces are replaced by their tangent planes at the points closest to y, for planes
/// the shares are the minimum over lambda >= 0, sum 1, of
///   sum of lambda_f h_f + rho/2 |sum of lambda_f n_f|^2,   h_f the height of x over plane f,
/// and y = x + rho sum of lambda_f n_f. (Where four faces around a corner leave a choice between shares, it is a matter
/// of (rho theta / size of a face)^2 of the force.) For a point that is so deep behind the faces that y would be there
/// too, the planes are those that are seen from as far in front: nothing changes for flat faces.
///
/// `distance` is d(x), negative behind the faces, and `direction` its gradient. The first face is the closest one of x;
/// the others are those that hang together with it. What comes back is kept in the storage of `touch`.
RoundedDistance rounded_distance(std::span<const CurvedFace> faces, const NodeQuad& x, double distance,
                                 const NodeQuad& direction, double radius, std::vector<BallTouch> touch = {});

/// How far in front of x the faces are looked at: y - x, or more for a point that is deep behind them [m].
inline double view_distance(double distance, double radius) {
  return std::max(radius, radius / 2 - distance);
}

}  // namespace couplet::solid
