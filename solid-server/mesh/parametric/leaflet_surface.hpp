#pragma once
// The mid-surface of one valve leaflet in its third of a tube.

#include <Eigen/Core>

namespace couplet::solid {

struct LeafletShape {
  double tube_radius = 10.5e-3;          // R [m]
  double height = 14.7e-3;               // H: from the lowest point of the attachment to the commissures [m]
  double attachment_exponent = 2;        // p: the attachment rises as |u|^p
  double opening = 0.5e-3;               // eps: how far the free edge's middle stands from the tip of its sector [m]
  double sag = 1.5e-3;                   // how far the free edge's middle hangs below the commissures [m]
  double bulge = 1.8e-3;                 // of the belly, out of the ruled surface [m]
  double bulge_angle = 0.6108652381980;  // its direction below the radial one: 35 degrees [rad]
};

/// A slightly open leaflet of a trileaflet valve (own closed form, after published leaflet proportions). x is radial
/// through the leaflet's middle, z downstream along the tube. u in [-1, 1] runs from commissure to commissure, v in [0,
/// 1] from the attachment on the tube to the free edge:
///   attachment A(u) = (R cos(theta), R sin(theta), H |u|^p), theta = theta_m u
///   free edge  F(u) = (d + sqrt(eps^2 + y^2/3 (1 - 3 eps^2/y_m^2)), y, H - sag (1 - u^2)), y = y_m u, y_m = R
///   sin(theta_m) P(u, v) = (1 - v) A + v F + 4 bulge v (1 - v) (1 - u^2)^2 (cos(angle), 0, -sin(angle))
/// The leaflet keeps within its sector of 120 degrees, whose tip stands at x = d = c/sin(60 deg): at a distance c from
/// the planes between the leaflets, on which neighbours would meet at c = 0. The sector meets the tube at
/// theta_m = 60 deg - asin(c/R).
class LeafletSurface {
 public:
  /// `clearance`: c, half the distance that the mid-surfaces of neighbours keep [m]. Throws SceneError when the lengths
  /// do not fit each other.
  LeafletSurface(const LeafletShape& shape, double clearance);

  Eigen::Vector3d position(double u, double v) const;
  /// Unit normal away from the axis of the tube: on the side of the aorta.
  Eigen::Vector3d normal(double u, double v) const;
  /// Unit tangent from commissure to commissure (dP/du).
  Eigen::Vector3d circumferential(double u, double v) const;

  /// u and v of the point of the surface at (y, z); nearest ends for points a little outside.
  Eigen::Vector2d parameters_at(double y, double z) const;

  /// The point at normal distance s [m] from the mid-surface, aortic side positive. Along the attachment it is moved
  /// along the leaflet onto the tube; that shear dies out quadratically over three times its difference between the
  /// leaflet's two sides, so that no part leaves the tube and no element folds. `thickness` [m]: |s| is at most half.
  Eigen::Vector3d offset_position(double u, double v, double s, double thickness) const;

 private:
  struct Tangents {
    Eigen::Vector3d u, v;
  };
  Tangents tangents(double u, double v) const;
  /// How far the attachment's point at normal distance s moves along the leaflet to stand on the tube [m].
  double shear_at_attachment(double u, double s) const;
  /// Unit vector in the leaflet, perpendicular to the attachment, towards the free edge.
  Eigen::Vector3d away_from_attachment(double u, double v) const;

  LeafletShape shape_;
  double tip_ = 0;        // d [m]
  double theta_max_ = 0;  // theta_m [rad]
  double y_max_ = 0;      // y_m [m]
  double narrowing_ = 0;  // 1 - 3 eps^2/y_m^2
};

}  // namespace couplet::solid
