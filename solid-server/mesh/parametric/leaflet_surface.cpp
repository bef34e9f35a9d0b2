#include "solid-server/mesh/parametric/leaflet_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

constexpr double sixty_degrees = std::numbers::pi / 3;

void refuse(const std::string& sentence, const std::string& advice) {
  throw report::SceneError("valve", sentence, advice);
}

std::string millimetres(double length) {
  return report::text(length * 1e3) + " mm";
}

void check_shape(const LeafletShape& shape, double clearance) {
  const double radius = shape.tube_radius;
  if (!(radius > 0))
    refuse("a tube_radius of " + millimetres(radius) + " is not above 0", "give the tube's inner radius");
  if (!(shape.height > 0.2 * radius && shape.height < 5 * radius))
    refuse("a height of " + millimetres(shape.height) + " does not fit a tube_radius of " + millimetres(radius),
           "choose 0.2 to 5 times the radius; 1.4 is usual");
  if (!(shape.attachment_exponent >= 1.5 && shape.attachment_exponent <= 4))
    refuse("an attachment_exponent of " + report::text(shape.attachment_exponent) + " is not between 1.5 and 4",
           "choose 2");
  if (!(shape.opening > 0 && shape.opening < 0.4 * radius))
    refuse("an opening of " + millimetres(shape.opening) + " is not between 0 and 0.4 times the tube_radius",
           "choose some 0.05 times the radius");
  if (!(shape.sag >= 0 && shape.sag < 0.5 * shape.height))
    refuse("a sag of " + millimetres(shape.sag) + " is not between 0 and half the height",
           "choose 0.1 times the height");
  if (!(shape.bulge >= 0 && shape.bulge <= 0.25 * radius))
    refuse("a bulge of " + millimetres(shape.bulge) + " is not between 0 and 0.25 times the tube_radius",
           "choose 0.17 times the radius");
  if (!(clearance >= 0 && clearance < 0.1 * radius))
    refuse("thickness and commissure_gap of " + millimetres(2 * clearance) +
               " together are not below 0.2 times the tube_radius",
           "choose a thinner leaflet");
}

}  // namespace

LeafletSurface::LeafletSurface(const LeafletShape& shape, double clearance) : shape_(shape) {
  check_shape(shape, clearance);
  tip_ = clearance / std::sin(sixty_degrees);
  theta_max_ = sixty_degrees - std::asin(clearance / shape.tube_radius);
  y_max_ = shape.tube_radius * std::sin(theta_max_);
  narrowing_ = 1 - 3 * shape.opening * shape.opening / (y_max_ * y_max_);
}

Eigen::Vector3d LeafletSurface::position(double u, double v) const {
  const double theta = theta_max_ * u, y = y_max_ * u, R = shape_.tube_radius, H = shape_.height;
  const Eigen::Vector3d attachment(R * std::cos(theta), R * std::sin(theta),
                                   H * std::pow(std::abs(u), shape_.attachment_exponent));
  const Eigen::Vector3d free_edge(tip_ + std::sqrt(shape_.opening * shape_.opening + y * y / 3 * narrowing_), y,
                                  H - shape_.sag * (1 - u * u));
  const double bulge = 4 * shape_.bulge * v * (1 - v) * (1 - u * u) * (1 - u * u);
  return (1 - v) * attachment + v * free_edge +
         bulge * Eigen::Vector3d(std::cos(shape_.bulge_angle), 0, -std::sin(shape_.bulge_angle));
}

LeafletSurface::Tangents LeafletSurface::tangents(double u, double v) const {
  const double theta = theta_max_ * u, y = y_max_ * u, R = shape_.tube_radius, H = shape_.height;
  const double p = shape_.attachment_exponent, eps = shape_.opening;
  const double x_free = std::sqrt(eps * eps + y * y / 3 * narrowing_);
  const Eigen::Vector3d attachment(R * std::cos(theta), R * std::sin(theta), H * std::pow(std::abs(u), p));
  const Eigen::Vector3d free_edge(tip_ + x_free, y, H - shape_.sag * (1 - u * u));
  const Eigen::Vector3d attachment_du(-R * theta_max_ * std::sin(theta), R * theta_max_ * std::cos(theta),
                                      std::copysign(H * p * std::pow(std::abs(u), p - 1), u));
  const Eigen::Vector3d free_edge_du(y * y_max_ / 3 * narrowing_ / x_free, y_max_, 2 * shape_.sag * u);
  const Eigen::Vector3d outwards(std::cos(shape_.bulge_angle), 0, -std::sin(shape_.bulge_angle));
  const double w = 1 - u * u;
  return {(1 - v) * attachment_du + v * free_edge_du - 16 * shape_.bulge * v * (1 - v) * w * u * outwards,
          free_edge - attachment + 4 * shape_.bulge * (1 - 2 * v) * w * w * outwards};
}

Eigen::Vector3d LeafletSurface::normal(double u, double v) const {
  // At the commissures dP/dv is 0, but the normal has a limit there.
  constexpr double u_last = 1 - 1e-6;
  const Tangents tangent = tangents(std::clamp(u, -u_last, u_last), v);
  return tangent.u.cross(tangent.v).normalized();
}

Eigen::Vector3d LeafletSurface::circumferential(double u, double v) const {
  return tangents(u, v).u.normalized();
}

Eigen::Vector2d LeafletSurface::parameters_at(double y, double z) const {
  // Along a line y = const, z rises with v: bisection, which the vanishing lines at the commissures cannot disturb.
  // There u follows from (1 - v) R sin(theta_m u) + v y_m u = |y|, whose left side is concave: Newton from 0 rises to
  // the root.
  const double y_wanted = std::min(std::abs(y), y_max_);
  const auto u_at = [&](double v) {
    double u = 0;
    for (int step = 0; step < 50; ++step) {
      const double missing = y_wanted - (1 - v) * shape_.tube_radius * std::sin(theta_max_ * u) - v * y_max_ * u;
      const double slope = (1 - v) * shape_.tube_radius * theta_max_ * std::cos(theta_max_ * u) + v * y_max_;
      const double next = std::min(u + missing / slope, 1.0);
      if (next <= u) break;  // rounding stops the rise
      u = next;
    }
    return u;
  };
  double low = 0, high = 1;
  for (int step = 0; step < 54; ++step) {  // to the last bit of a double in [0, 1]
    const double v = (low + high) / 2;
    (position(u_at(v), v).z() < z ? low : high) = v;
  }
  const double v = (low + high) / 2;
  return {std::copysign(u_at(v), y), v};
}

Eigen::Vector3d LeafletSurface::away_from_attachment(double u, double v) const {
  const Eigen::Vector3d along = tangents(u, 0).u.normalized();
  const Eigen::Vector3d n = normal(u, v);
  return n.cross(along).normalized();
}

double LeafletSurface::shear_at_attachment(double u, double s) const {
  // |a + c e| = R in the cross-section, with a: the point at normal distance s, e: along the leaflet.
  const Eigen::Vector2d a = (position(u, 0) + s * normal(u, 0)).head<2>();
  const Eigen::Vector2d e = away_from_attachment(u, 0).head<2>();
  const double ee = e.squaredNorm(), ae = a.dot(e), rest = a.squaredNorm() - shape_.tube_radius * shape_.tube_radius;
  const double discriminant = ae * ae - ee * rest;
  if (!(discriminant >= 0 && ae < 0))
    refuse("the leaflet runs along the tube at its attachment", "choose a smaller bulge or a thinner leaflet");
  return rest / (-ae + std::sqrt(discriminant));  // the root that is 0 where the point is on the tube already
}

Eigen::Vector3d LeafletSurface::offset_position(double u, double v, double s, double thickness) const {
  const Eigen::Vector3d middle = position(u, v);
  const Eigen::Vector3d offset = middle + s * normal(u, v);
  const double shear = shear_at_attachment(u, s);
  const double range =
      3 * (std::abs(shear_at_attachment(u, thickness / 2)) + std::abs(shear_at_attachment(u, -thickness / 2)));
  const double distance = (middle - position(u, 0)).norm();
  if (distance >= range && distance > 0) return offset;
  const double share = distance > 0 ? (1 - distance / range) * (1 - distance / range) : 1;
  return offset + share * shear * away_from_attachment(u, v);
}

}  // namespace couplet::solid
