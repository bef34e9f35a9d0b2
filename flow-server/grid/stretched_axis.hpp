#pragma once
// One direction of a Cartesian grid: where the faces between cells stand.

#include <vector>

namespace couplet::flow {

/// Cells i = 0 .. n_cells-1 lie between face(i) and face(i + 1). Indices beyond both ends are answered as well: a
/// periodic axis repeats itself, any other is mirrored at its ends.
class StretchedAxis {
 public:
  /// `faces`: at least two, strictly rising [m]. Throws SceneError naming the first pair that does not rise.
  StretchedAxis(std::vector<double> faces, bool is_periodic);

  int n_cells() const { return static_cast<int>(faces_.size()) - 1; }
  bool is_periodic() const { return is_periodic_; }
  double start() const { return faces_.front(); }
  double end() const { return faces_.back(); }
  double length() const { return end() - start(); }

  double face(int i) const;                                                 // left face of cell i [m]
  double centre(int i) const { return 0.5 * (face(i) + face(i + 1)); }      // [m]
  double width(int i) const { return face(i + 1) - face(i); }               // [m]
  double distance(int i) const { return 0.5 * (width(i) + width(i + 1)); }  // from centre i to centre i + 1 [m]

  double smallest_width() const;
  double largest_width() const;
  /// Largest ratio of the widths of two neighbours, at least 1.
  double largest_growth() const;

  const std::vector<double>& faces() const { return faces_; }

 private:
  std::vector<double> faces_;
  bool is_periodic_;
};

/// A part of an axis in which cells are no wider than `width`.
struct FineRegion {
  double start = 0, end = 0;  // [m]
  double width = 0;           // [m]
};

std::vector<double> uniform_faces(double start, double end, int n_cells);

/// Faces from `start` to `end`: uniform cells of the given width (or a little less, so that they fit) in each fine
/// region; between and beyond the regions cells grow from one to the next by a constant ratio, at most
/// `largest_growth`, up to `largest_width`. Second order needs such smooth growth. As whole cells must
/// fill each part, neighbours may differ by a little more. Throws SceneError where that is more than three times the
/// growth, where regions overlap, do not rise or leave the axis, and beyond 100000 cells.
std::vector<double> stretched_faces(double start, double end, const std::vector<FineRegion>& regions,
                                    double largest_growth, double largest_width);

/// n_cells whose widths grow by a constant ratio from the middle to both ends, where they are `stretching` times as
/// wide as in the middle. For tests and benchmarks of stretched grids.
std::vector<double> symmetrically_stretched_faces(double start, double end, int n_cells, double stretching);

}  // namespace couplet::flow
