#include "flow-server/one_dimensional/glottal_section.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include "flow-server/one_dimensional/quadratic_face.hpp"
#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {
constexpr double nowhere = -std::numeric_limits<double>::infinity();
// Pieces reach this much farther at both ends, so that round-off opens no crack between two faces [share of the
// channel].
constexpr double section_overlap = 1e-10;
}  // namespace

GlottalSection::GlottalSection(const FoldSurface& surface, const StationAxis& axis, const GapRule& rule, double exit)
    : surface_(&surface), axis_(&axis), rule_(rule), n_lines_(2 * rule.n_strips) {
  const NodePositions& reference = surface.reference();
  if (!(reference.y.maxCoeff() < rule.midplane)) {
    std::ostringstream found;
    found << "the midplane y = " << rule.midplane
          << " m does not lie above the fold, which reaches y = " << reference.y.maxCoeff() << " m";
    throw report::SceneError("flow.glottis.midplane", found.str(),
                             "the fold must lie below the midplane, its mirror image above it");
  }
  Eigen::Index most_upstream = 0;
  inlet_ = reference.x.minCoeff(&most_upstream);
  wall_ = reference.y[most_upstream];
  const auto n_rows = static_cast<Eigen::Index>(surface.rows().size());
  highest_.resize(axis.n_stations(), n_lines_ * n_rows);
  weight_.resize(n_lines_ * n_rows);
  for (Eigen::Index row = 0; row < n_rows; ++row) {
    const FaceRow& r = surface.rows()[static_cast<std::size_t>(row)];
    weight_.segment(n_lines_ * row, n_lines_) =
        (r.z_high - r.z_low) / static_cast<double>(n_lines_) * (rule.half_length ? 2 : 1);
  }
  length_ = weight_.sum();
  for (int strip = 0; strip < rule.n_strips; ++strip) {
    for (const double gauss_point : {-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)}) {
      const double s = -1 + (2 * strip + 1 + gauss_point) / rule.n_strips;
      auto& shape = shape_.emplace_back();
      for (std::size_t q = 0; q <= n_pieces; ++q)
        shape[q] = quadratic_face_point(-1 + 2.0 * static_cast<double>(q) / n_pieces, s).value;
    }
  }
  highest_.setConstant(nowhere);
  draw_lines(reference, exit);
  refuse_holes();
}

void GlottalSection::refuse_holes() const {
  for (Eigen::Index line = 0; line < highest_.cols(); ++line) {
    for (Eigen::Index k = 0; k < highest_.rows(); ++k) {
      if (highest_(k, line) != nowhere) continue;
      const FaceRow& row = surface_->rows()[static_cast<std::size_t>(line / n_lines_)];
      std::ostringstream found;
      found << "it has a hole between z = " << row.z_low << " and " << row.z_high << " m, at "
            << 100 * axis_->fraction()[k] << " % of the way from its upstream end to the exit line";
      throw report::PeerError("surface of the fold", found.str(),
                              "the wetted surface must be complete from its upstream end to the exit line");
    }
  }
}

void GlottalSection::measure(const NodePositions& moved, double exit, Eigen::ArrayXd& area, Eigen::ArrayXd& perimeter) {
  highest_.setConstant(wall_);
  draw_lines(moved, exit);
  area.setZero();
  for (Eigen::Index line = 0; line < highest_.cols(); ++line) {
    area += weight_[line] * (2 * (rule_.midplane - highest_.col(line))).max(rule_.smallest_gap);
  }
  perimeter = 2 * (length_ + area / length_);
}

void GlottalSection::draw_lines(const NodePositions& moved, double exit) {
  const double scale = 1 / (exit - inlet_);
  for (const FaceBatch& batch : surface_->batches()) {
    std::array<Lanes, 8> node_xi, node_y;
    for (std::size_t i = 0; i < 8; ++i) {
      for (int lane = 0; lane < n_lanes; ++lane) {
        const auto node = batch.node[i][static_cast<std::size_t>(lane)];
        node_xi[i][lane] = (moved.x[node] - inlet_) * scale;
        node_y[i][lane] = moved.y[node];
      }
    }
    for (std::size_t line = 0; line < shape_.size(); ++line) {
      Points xi, y;
      for (std::size_t q = 0; q <= n_pieces; ++q) {
        xi[q] = shape_[line][q][0] * node_xi[0];
        y[q] = shape_[line][q][0] * node_y[0];
        for (std::size_t i = 1; i < 8; ++i) {
          xi[q] += shape_[line][q][i] * node_xi[i];
          y[q] += shape_[line][q][i] * node_y[i];
        }
      }
      for (int lane = 0; lane < batch.n_faces; ++lane) {
        draw_face(xi, y, lane,
                  highest_.col(n_lines_ * batch.row[static_cast<std::size_t>(lane)] + static_cast<int>(line)));
      }
    }
  }
}

void GlottalSection::draw_face(const Points& xi, const Points& y, int lane, Eigen::Ref<Eigen::ArrayXd> highest) const {
  const Eigen::ArrayXd& fraction = axis_->fraction();
  const int n_stations = axis_->n_stations();
  for (std::size_t q = 0; q < n_pieces; ++q) {
    const double from = xi[q][lane], to = xi[q + 1][lane];
    const double low = std::min(from, to) - section_overlap, high = std::max(from, to) + section_overlap;
    if (low > 1 || high < 0) continue;
    const double y_from = y[q][lane], y_to = y[q + 1][lane];
    const bool is_upright = high - low < 4 * section_overlap;
    const double slope = is_upright ? 0 : (y_to - y_from) / (to - from);
    const double start = is_upright ? std::max(y_from, y_to) : y_from;
    for (int k = axis_->first_at_or_after(low); k < n_stations && fraction[k] <= high; ++k) {
      highest[k] = std::max(highest[k], start + slope * (fraction[k] - from));
    }
  }
}

}  // namespace couplet::flow
