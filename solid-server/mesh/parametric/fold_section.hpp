#pragma once
// The cross-section of the idealised vocal fold in the plane of the flow: x along it, y from the lateral wall. Straight
// superior face, flat medial face, convex circular inferior face, a fillet at each end of the medial face.

#include <Eigen/Core>
#include <array>
#include <vector>

namespace couplet::solid {

/// Lengths in metres.
struct FoldSectionShape {
  double medial_thickness = 0;    // T: flat medial length between the fillets [m]
  double width = 0.013;           // W: along the flow at the wall [m]
  double depth = 0.010;           // D: from the wall to the medial face [m]
  double superior_lean = 2;       // alpha_s: of the superior face, upstream with growing y [deg]
  double inferior_bulge = 0.08;   // kappa: sagitta of the inferior face over its chord [1]
  double inferior_fillet = 5e-4;  // r_i [m]
  double superior_fillet = 5e-4;  // r_s [m]
};

/// The corners A (upstream) and E (downstream) at the wall, the sharp corners B and C, the ends of the fillets B1, B2
/// and C1, C2, the circles that the arcs are part of.
struct FoldSection {
  Eigen::Vector2d A, B, C, E, B1, B2, C1, C2;  // [m]
  Eigen::Vector2d inferior_centre;             // O
  double inferior_radius = 0;                  // R [m]
  Eigen::Vector2d inferior_fillet_centre, superior_fillet_centre;
};

/// Finds the sharp corner B for which the medial face between the fillets has the wanted length. Throws SceneError when
/// the lengths do not fit together.
FoldSection make_fold_section(const FoldSectionShape& shape);

/// Points at equal arc lengths on the outline: n_intervals + 1 of them from the first end to the second.
std::vector<Eigen::Vector2d> divide_arc(const Eigen::Vector2d& centre, const Eigen::Vector2d& from,
                                        const Eigen::Vector2d& to, int n_intervals);
std::vector<Eigen::Vector2d> divide_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int n_intervals);

}  // namespace couplet::solid
