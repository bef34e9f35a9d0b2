#pragma once
// Area and perimeter of the glottis along the flow, from the deformed surface of one fold.

#include <Eigen/Core>
#include <vector>

#include "flow-server/one_dimensional/fold_surface.hpp"
#include "flow-server/one_dimensional/station_axis.hpp"

namespace couplet::flow {

struct GapRule {
  double midplane = 0;       // y of the plane midway between the two folds [m]
  double smallest_gap = 0;   // counted where the folds are closer than this [m]
  bool half_length = false;  // the surface is half of the fold along z
  int n_strips = 4;          // into which a row of faces is cut along z
};

/// The gap is measured along lines of material, two at the Gauss points of each strip of a row of faces; each line is a
/// polyline with four pieces a face. At a station it reaches as far as its highest piece there; the other fold is its
/// mirror image: gap = 2 (midplane - y), A0 = integral of the gap over z. Where no piece stands above a station the
/// wall is seen, at the y of the most upstream node.
class GlottalSection {
 public:
  /// Throws PeerError when the reference surface reaches the midplane or leaves a hole between its upstream end and x =
  /// exit.
  GlottalSection(const FoldSurface& surface, const StationAxis& axis, const GapRule& rule, double exit);

  double inlet() const { return inlet_; }    // x of the most upstream node of the reference surface [m]
  double length() const { return length_; }  // of the whole fold along z [m]

  /// Stations at inlet + xi_k (exit - inlet). Writes area (n_stations) [m^2] and perimeter (n_stations) [m], that of
  /// the rectangle of equal area and length.
  void measure(const NodePositions& moved, double exit, Eigen::ArrayXd& area, Eigen::ArrayXd& perimeter);

 private:
  static constexpr int n_pieces = 4;  // of a line across one face
  using Points = std::array<Lanes, n_pieces + 1>;

  void draw_lines(const NodePositions& moved, double exit);
  void draw_face(const Points& xi, const Points& y, int lane, Eigen::Ref<Eigen::ArrayXd> highest) const;
  void refuse_holes() const;

  const FoldSurface* surface_;
  const StationAxis* axis_;
  GapRule rule_;
  double inlet_ = 0;                                                    // [m]
  double wall_ = 0;                                                     // y of the wall [m]
  double length_ = 0;                                                   // [m]
  std::vector<std::array<std::array<double, 8>, n_pieces + 1>> shape_;  // N_i at the points of the lines of a face
  Eigen::Index n_lines_;                                                // of a row
  Eigen::ArrayXXd highest_;  // (n_stations, n_lines of all rows): y that each line reaches [m]
  Eigen::ArrayXd weight_;    // (n_lines): length along z that a line stands for [m]
};

}  // namespace couplet::flow
