#include "solid-server/mesh/parametric/section_grid.hpp"

#include <algorithm>
#include <functional>

namespace couplet::solid {

namespace {

struct Segment {
  double weight;  // half elements are shared out in proportion to it
  std::function<std::vector<Eigen::Vector2d>(int)> divide;
  int n_intervals = 1;
};

/// Gives each segment one half element, then the next one always to the segment with the longest ones.
void share_out(std::vector<Segment>& segments, int n_intervals) {
  const auto interval = [](const Segment& s) { return s.weight / s.n_intervals; };
  for (int given = static_cast<int>(segments.size()); given < n_intervals; ++given)
    ++std::max_element(segments.begin(), segments.end(), [&](const Segment& a, const Segment& b) {
        return interval(a) < interval(b) * (1 - 1e-9);
      })->n_intervals;
}

std::vector<Eigen::Vector2d> join(const std::vector<Segment>& segments) {
  std::vector<Eigen::Vector2d> points;
  for (const Segment& segment : segments) {
    const auto piece = segment.divide(segment.n_intervals);
    points.insert(points.end(), piece.begin() + (points.empty() ? 0 : 1), piece.end());
  }
  return points;
}

double arc_length(const Eigen::Vector2d& centre, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d start = from - centre, end = to - centre;
  return start.norm() * std::abs(std::atan2(start.x() * end.y() - start.y() * end.x(), start.dot(end)));
}

/// The medial face from B1 to C2. With five half elements or more B2, the middle of the flat part, C1 and the middle of
/// the superior fillet are nodes. A fillet counts half its length, so that a coarse mesh spends one element on it and
/// no more: its smallest element sets the stable time step.
std::vector<Eigen::Vector2d> medial_points(const FoldSection& s, int n_intervals) {
  const Eigen::Vector2d flat_middle = (s.B2 + s.C1) / 2;
  const auto fillet_middle = divide_arc(s.superior_fillet_centre, s.C1, s.C2, 2)[1];
  const auto arc = [](Eigen::Vector2d centre, Eigen::Vector2d from, Eigen::Vector2d to) {
    return Segment{arc_length(centre, from, to) / 2, [=](int n) { return divide_arc(centre, from, to, n); }};
  };
  const auto line = [](Eigen::Vector2d from, Eigen::Vector2d to) {
    return Segment{(to - from).norm(), [=](int n) { return divide_line(from, to, n); }};
  };
  std::vector<Segment> segments = {arc(s.inferior_fillet_centre, s.B1, s.B2), line(s.B2, flat_middle),
                                   line(flat_middle, s.C1), arc(s.superior_fillet_centre, s.C1, fillet_middle),
                                   arc(s.superior_fillet_centre, fillet_middle, s.C2)};
  if (n_intervals < 5)
    segments = {arc(s.inferior_fillet_centre, s.B1, s.B2), line(s.B2, s.C1), arc(s.superior_fillet_centre, s.C1, s.C2)};
  if (n_intervals < 3) return divide_line(s.B1, s.C2, n_intervals);
  share_out(segments, n_intervals);
  return join(segments);
}

}  // namespace

SectionGrid::SectionGrid(const FoldSection& section, int n_x, int n_y)
    : n_i_(2 * n_x), n_j_(2 * n_y), point_(static_cast<std::size_t>((n_i_ + 1) * (n_j_ + 1))) {
  const auto wall = divide_line(section.A, section.E, n_i_);
  const auto medial = medial_points(section, n_i_);
  const auto inferior = divide_arc(section.inferior_centre, section.A, section.B1, n_j_);
  const auto superior = divide_line(section.E, section.C2, n_j_);
  for (int i = 0; i <= n_i_; ++i) {
    point(i, 0) = wall[static_cast<std::size_t>(i)];
    point(i, n_j_) = medial[static_cast<std::size_t>(i)];
  }
  for (int j = 0; j <= n_j_; ++j) {
    point(0, j) = inferior[static_cast<std::size_t>(j)];
    point(n_i_, j) = superior[static_cast<std::size_t>(j)];
  }
  interpolate_from_sides();
  smooth_corners();
  straighten_inner_edges();
}

const Eigen::Vector2d& SectionGrid::at(int i, int j) const {
  return point_[static_cast<std::size_t>(j * (n_i_ + 1) + i)];
}

Eigen::Vector2d& SectionGrid::point(int i, int j) {
  return point_[static_cast<std::size_t>(j * (n_i_ + 1) + i)];
}

/// Transfinite interpolation of the four sides (Gordon and Hall 1973):
/// X(s,t) = (1-t) X(s,0) + t X(s,1) + (1-s) X(0,t) + s X(1,t) - the bilinear interpolation of the corners.
void SectionGrid::interpolate_from_sides() {
  for (int j = 1; j < n_j_; ++j)
    for (int i = 1; i < n_i_; ++i) {
      const double s = static_cast<double>(i) / n_i_, t = static_cast<double>(j) / n_j_;
      const Eigen::Vector2d sides = (1 - t) * at(i, 0) + t * at(i, n_j_) + (1 - s) * at(0, j) + s * at(n_i_, j);
      const Eigen::Vector2d corners =
          (1 - t) * ((1 - s) * at(0, 0) + s * at(n_i_, 0)) + t * ((1 - s) * at(0, n_j_) + s * at(n_i_, n_j_));
      point(i, j) = sides - corners;
    }
}

/// Moves the inner corner nodes until xi(X) and eta(X) are harmonic (Winslow 1967, J. Comput. Phys. 1:149), that is
///   alpha X_xixi - 2 beta X_xieta + gamma X_etaeta = 0,  alpha = |X_eta|^2, beta = X_xi . X_eta, gamma = |X_xi|^2,
/// by central differences. Such a grid does not fold; it leaves elements more room beside the flat corner at B1 than
/// the mean of neighbours would, which lengthens the stable time step by a quarter to a third.
void SectionGrid::smooth_corners() {
  const double enough = 1e-12 * (at(n_i_, 0) - at(0, 0)).norm();
  double moved = 2 * enough;
  for (int sweep = 0; sweep < 10000 && moved > enough; ++sweep) {
    moved = 0;
    for (int j = 2; j < n_j_; j += 2)
      for (int i = 2; i < n_i_; i += 2) {
        const Eigen::Vector2d &west = at(i - 2, j), &east = at(i + 2, j), &south = at(i, j - 2), &north = at(i, j + 2);
        const Eigen::Vector2d along_xi = (east - west) / 2, along_eta = (north - south) / 2;
        const Eigen::Vector2d mixed = (at(i + 2, j + 2) - at(i - 2, j + 2) - at(i + 2, j - 2) + at(i - 2, j - 2)) / 4;
        const double alpha = along_eta.squaredNorm(), beta = along_xi.dot(along_eta), gamma = along_xi.squaredNorm();
        const Eigen::Vector2d place =
            (alpha * (east + west) + gamma * (north + south) - 2 * beta * mixed) / (2 * (alpha + gamma));
        moved = std::max(moved, (place - at(i, j)).norm());
        point(i, j) = place;
      }
  }
}

void SectionGrid::straighten_inner_edges() {
  for (int j = 2; j < n_j_; j += 2)
    for (int i = 1; i < n_i_; i += 2) point(i, j) = (at(i - 1, j) + at(i + 1, j)) / 2;
  for (int j = 1; j < n_j_; j += 2)
    for (int i = 2; i < n_i_; i += 2) point(i, j) = (at(i, j - 1) + at(i, j + 1)) / 2;
}

}  // namespace couplet::solid
