#pragma once
// A surface over time, for ParaView.

#include <filesystem>
#include <string>
#include <vector>

#include "flow-server/immersed/body_surface.hpp"
#include "proto/store/result_file.hpp"

namespace couplet::flow {

/// A field of the corners or of the triangles of a surface.
struct SurfaceResult {
  std::string name;
  std::string unit;
  surface::NodeArray values;  // (n_corners or n_triangles, 1 or 3)
  bool is_of_triangles = false;
};

/// results/NAME.h5 and results/NAME.xmf: the triangles of a surface, moved by their displacement, with the velocity of
/// their corners and further fields. One rank writes them: every rank knows the whole surface.
class SurfaceResults {
 public:
  /// The surface at rest; its name is that of the files. When they are there and time > 0, they are continued.
  SurfaceResults(const std::filesystem::path& results_folder, const BodySurface& at_rest, double time);

  /// The same fields every time.
  void append(double time, const BodySurface& surface, const std::vector<SurfaceResult>& results = {});

 private:
  std::vector<Point> at_rest_;
  store::ResultWriter writer_;
};

}  // namespace couplet::flow
