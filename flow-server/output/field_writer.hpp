#pragma once
// Fields of the flow over time, written by all ranks to one file, for ParaView.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "flow-server/output/flow_measurement.hpp"
#include "flow-server/output/parallel_file.hpp"

namespace couplet::flow {

enum class FieldQuantity { velocity, pressure, vorticity, q_criterion, swirling_strength };

/// A part of the grid that is stored. With a stride the cells of the picture are as many cells wide, and hold the
/// values of the cell in their middle.
struct FieldRegion {
  std::string name;
  Box cells;  // in indices of the whole
  int stride = 1;
  std::vector<FieldQuantity> quantities;
  Precision precision = Precision::single;
};

/// results/flow.h5 and, for each region, results/NAME.xmf:
///   grid/NAME/x, y, z     faces of the picture's cells [m]
///   state/I/time          [s]
///   state/I/NAME/FIELD    (nz, ny, nx) or (nz, ny, nx, 3) at cell centres
/// A state is complete on disk before the .xmf names it; the .xmf is replaced as a whole.
class FieldWriter {
 public:
  /// Collective. Where files are there and time > 0 they are continued: states later than `time` are dropped. Throws
  /// FileError.
  FieldWriter(const std::filesystem::path& results_folder, const StretchedGrid& grid,
              const BlockDecomposition& decomposition, std::vector<FieldRegion> regions, double time);

  /// Collective.
  void append(const FlowPart& part);

 private:
  void write_grid();
  void keep_states_up_to(double time);
  void write_listing() const;

  std::filesystem::path folder_;
  const StretchedGrid& grid_;
  const BlockDecomposition& decomposition_;
  std::vector<FieldRegion> regions_;
  std::unique_ptr<ParallelFile> file_;
  std::vector<double> times_;  // of the states in the file
};

}  // namespace couplet::flow
