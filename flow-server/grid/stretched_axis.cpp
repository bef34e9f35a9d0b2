#include "flow-server/grid/stretched_axis.hpp"

#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"

namespace couplet::flow {

namespace {

using report::text;

/// More cells than any machine has memory for in three directions: a slip of a power of ten.
constexpr double most_cells = 100000;

void refuse_too_many(double n_cells) {
  if (n_cells <= most_cells) return;
  throw report::SceneError("axis", "would have more than " + text(most_cells) + " cells", "let cells be wider");
}

/// Widths that grow from `first` by one ratio, at most `growth`, up to about `last`, and fill `length` exactly.
std::vector<double> growing_widths(double length, double first, double growth, double last) {
  std::vector<double> widths;
  double sum = 0;
  for (double width = std::min(first * growth, last); sum + 0.5 * width < length;
       width = std::min(width * growth, last)) {
    widths.push_back(width);
    sum += width;
    refuse_too_many(static_cast<double>(widths.size()));
  }
  if (widths.empty()) return {length};
  // The rest, less than half a cell more or less, is shared in proportion to the place in the row, so that no
  // neighbours differ by more than before by more than a little.
  double weights = 0;
  for (std::size_t i = 0; i < widths.size(); ++i) weights += widths[i] * static_cast<double>(i + 1);
  for (std::size_t i = 0; i < widths.size(); ++i)
    widths[i] += (length - sum) * widths[i] * static_cast<double>(i + 1) / weights;
  return widths;
}

/// Fills a gap between two fine regions: grows from both sides towards the middle.
std::vector<double> bridging_widths(double length, double first, double last, double growth, double largest) {
  // Each side grows by itself until they meet where both have the same width.
  std::vector<double> left, right;
  double left_width = first, right_width = last, sum = 0;
  while (true) {
    const bool takes_left = left_width <= right_width;
    const double width = std::min((takes_left ? left_width : right_width) * growth, largest);
    if (sum + 0.5 * width >= length) break;
    sum += width;
    (takes_left ? left : right).push_back(width);
    (takes_left ? left_width : right_width) = width;
    refuse_too_many(static_cast<double>(left.size() + right.size()));
  }
  std::vector<double> widths = left;
  widths.insert(widths.end(), right.rbegin(), right.rend());
  if (widths.empty()) return {length};
  for (double& width : widths) width *= length / sum;
  return widths;
}

void append_widths(std::vector<double>& faces, const std::vector<double>& widths, double end) {
  for (const double width : widths) faces.push_back(faces.back() + width);
  faces.back() = end;  // exactly, whatever round-off the sum carries
}

}  // namespace

StretchedAxis::StretchedAxis(std::vector<double> faces, bool is_periodic)
    : faces_(std::move(faces)), is_periodic_(is_periodic) {
  if (faces_.size() < 2) throw report::SceneError("axis", "has fewer than two faces", "give at least two");
  for (std::size_t i = 1; i < faces_.size(); ++i) {
    if (!(faces_[i] > faces_[i - 1]) || !std::isfinite(faces_[i]))
      throw report::SceneError("axis",
                               "face " + std::to_string(i) + " at " + text(faces_[i]) + " m is not beyond face " +
                                   std::to_string(i - 1) + " at " + text(faces_[i - 1]) + " m",
                               "give faces in rising order");
  }
}

double StretchedAxis::face(int i) const {
  const int n = n_cells();
  if (i >= 0 && i <= n) return faces_[i];
  if (is_periodic_) {
    const int wrapped = ((i % n) + n) % n;
    return faces_[wrapped] + length() * ((i - wrapped) / n);
  }
  const int mirrored = std::clamp(i < 0 ? -i : 2 * n - i, 0, n);
  return i < 0 ? 2 * start() - faces_[mirrored] : 2 * end() - faces_[mirrored];
}

double StretchedAxis::smallest_width() const {
  double smallest = width(0);
  for (int i = 1; i < n_cells(); ++i) smallest = std::min(smallest, width(i));
  return smallest;
}

double StretchedAxis::largest_width() const {
  double largest = width(0);
  for (int i = 1; i < n_cells(); ++i) largest = std::max(largest, width(i));
  return largest;
}

double StretchedAxis::largest_growth() const {
  double growth = 1;
  for (int i = is_periodic_ ? -1 : 0; i + 1 < n_cells(); ++i)
    growth = std::max({growth, width(i + 1) / width(i), width(i) / width(i + 1)});
  return growth;
}

std::vector<double> uniform_faces(double start, double end, int n_cells) {
  std::vector<double> faces;
  for (int i = 0; i <= n_cells; ++i) faces.push_back(start + (end - start) * i / n_cells);
  return faces;
}

std::vector<double> stretched_faces(double start, double end, const std::vector<FineRegion>& regions,
                                    double largest_growth, double largest_width) {
  std::vector<double> faces{start};
  double last_width = 0;  // of the region before, 0: none
  for (const FineRegion& region : regions) {
    if (!(region.end > region.start) || region.start < faces.back() - 1e-12 * (end - start) ||
        region.end > end + 1e-12 * (end - start)) {
      throw report::SceneError("fine region",
                               "from " + text(region.start) + " to " + text(region.end) + " m does not lie between " +
                                   text(faces.back()) + " and " + text(end) + " m",
                               "give regions in rising order, inside the axis, without overlap");
    }
    refuse_too_many((region.end - region.start) / region.width);
    const int n_inside = std::max(1, static_cast<int>(std::ceil((region.end - region.start) / region.width - 1e-9)));
    const double width = (region.end - region.start) / n_inside;
    const double gap = region.start - faces.back();
    if (gap > 0.25 * width) {
      if (last_width > 0) {
        append_widths(faces, bridging_widths(gap, last_width, width, largest_growth, largest_width), region.start);
      } else {
        std::vector<double> widths = growing_widths(gap, width, largest_growth, largest_width);
        std::reverse(widths.begin(), widths.end());
        append_widths(faces, widths, region.start);
      }
    }
    append_widths(faces, std::vector<double>(static_cast<std::size_t>(n_inside), width), region.end);
    last_width = width;
  }
  const double rest = end - faces.back();
  if (last_width == 0) {
    refuse_too_many(rest / largest_width);
    const int n_cells = std::max(1, static_cast<int>(std::ceil(rest / largest_width - 1e-9)));
    return uniform_faces(start, end, n_cells);
  }
  if (rest > 0.25 * last_width) {
    append_widths(faces, growing_widths(rest, last_width, largest_growth, largest_width), end);
  } else {
    faces.back() = end;
  }
  // Whole cells must fill what regions leave; where that is little they differ by more than was asked.
  const double growth = StretchedAxis(faces, false).largest_growth();
  if (growth > 1 + 3 * (largest_growth - 1))
    throw report::SceneError("fine regions",
                             "neighbouring cells would differ by a factor of " + text(growth) +
                                 ", asked for is at most " + text(largest_growth),
                             "leave several cells of room beside each region, or move its ends to those of the axis");
  return faces;
}

std::vector<double> symmetrically_stretched_faces(double start, double end, int n_cells, double stretching) {
  // Widths ratio^m at m cells from the middle; the outermost is `stretching` times the innermost.
  const int n_half = (n_cells + 1) / 2;
  const double ratio = n_half > 1 ? std::pow(stretching, 1.0 / (n_half - 1)) : 1.0;
  std::vector<double> widths;
  double sum = 0;
  for (int i = 0; i < n_cells; ++i) {
    const int from_middle = i < n_cells / 2 ? n_half - 1 - i : i - (n_cells - n_half);
    widths.push_back(std::pow(ratio, from_middle));
    sum += widths.back();
  }
  for (double& width : widths) width *= (end - start) / sum;
  std::vector<double> faces{start};
  append_widths(faces, widths, end);
  return faces;
}

}  // namespace couplet::flow
