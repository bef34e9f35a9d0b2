#include "solid-server/mesh/parametric/fold_section.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

double to_radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// The section whose sharp corner B stands `sharp_thickness` upstream of C; nothing when no fillet fits there.
std::optional<FoldSection> section_with_corner(const FoldSectionShape& shape, double sharp_thickness) {
  const double D = shape.depth, r_i = shape.inferior_fillet, r_s = shape.superior_fillet, kappa = shape.inferior_bulge;
  const double lean = to_radians(shape.superior_lean);
  FoldSection s;
  s.A = {0, 0};
  s.E = {shape.width, 0};
  s.C = {shape.width - D * std::tan(lean), D};
  s.B = {s.C.x() - sharp_thickness, D};

  // Inferior face: an arc over the chord A-B with sagitta kappa |AB|, R = |AB| (1/(8 kappa) + kappa/2).
  const Eigen::Vector2d chord = s.B - s.A;
  const double length = chord.norm();
  const Eigen::Vector2d to_air = Eigen::Vector2d(-chord.y(), chord.x()) / length;
  s.inferior_radius = length * (1 / (8 * kappa) + kappa / 2);
  s.inferior_centre = (s.A + s.B) / 2 + to_air * (kappa * length - s.inferior_radius);

  // Fillet at B: a circle of radius r_i inside both the arc and the line y = D.
  const double reach = s.inferior_radius - r_i, rise = D - r_i - s.inferior_centre.y();
  if (reach <= std::abs(rise)) return std::nullopt;
  s.inferior_fillet_centre = {s.inferior_centre.x() - std::sqrt(reach * reach - rise * rise), D - r_i};
  s.B1 = s.inferior_centre + s.inferior_radius * (s.inferior_fillet_centre - s.inferior_centre).normalized();
  s.B2 = {s.inferior_fillet_centre.x(), D};

  // Fillet at C: tangent length r_s tan((90 deg - lean)/2).
  const double tangent = r_s * std::tan((std::numbers::pi / 2 - lean) / 2);
  s.C1 = s.C - Eigen::Vector2d(tangent, 0);
  s.C2 = s.C + tangent * Eigen::Vector2d(std::sin(lean), -std::cos(lean));
  s.superior_fillet_centre = s.C1 - Eigen::Vector2d(0, r_s);
  return s;
}

double flat_length(const std::optional<FoldSection>& section) {
  return section ? section->C1.x() - section->B2.x() : -1;
}

bool is_sound(const FoldSection& s) {
  return s.B1.x() > 0 && s.B1.y() > 0 && s.C2.y() > 0 && s.inferior_fillet_centre.y() > 0 && s.C1.x() > s.B2.x();
}

}  // namespace

FoldSection make_fold_section(const FoldSectionShape& shape) {
  // The flat length grows with the sharp one: halve the interval until it is as short as the numbers allow.
  double low = 0, high = shape.width;
  for (int halving = 0; halving < 200; ++halving) {
    const double middle = (low + high) / 2;
    (flat_length(section_with_corner(shape, middle)) < shape.medial_thickness ? low : high) = middle;
  }
  const auto section = section_with_corner(shape, high);
  if (!section || !is_sound(*section) || std::abs(flat_length(section) - shape.medial_thickness) > 1e-9 * shape.width)
    throw report::SceneError("vocal_fold",
                             "medial_thickness, width, depth, bulge and fillets do not fit together to a section",
                             "lower medial_thickness or the fillets, or raise width");
  return *section;
}

std::vector<Eigen::Vector2d> divide_arc(const Eigen::Vector2d& centre, const Eigen::Vector2d& from,
                                        const Eigen::Vector2d& to, int n_intervals) {
  const Eigen::Vector2d start = from - centre, end = to - centre;
  const double angle = std::atan2(start.x() * end.y() - start.y() * end.x(), start.dot(end));
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= n_intervals; ++i) {
    const double turn = angle * i / n_intervals, c = std::cos(turn), s = std::sin(turn);
    points.push_back(centre + Eigen::Vector2d(c * start.x() - s * start.y(), s * start.x() + c * start.y()));
  }
  points.front() = from;
  points.back() = to;
  return points;
}

std::vector<Eigen::Vector2d> divide_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int n_intervals) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= n_intervals; ++i) {
    const double fraction = static_cast<double>(i) / n_intervals;
    points.push_back((1 - fraction) * from + fraction * to);
  }
  return points;
}

}  // namespace couplet::solid
