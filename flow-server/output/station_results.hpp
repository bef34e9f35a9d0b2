#pragma once
// Fields along a line of moving stations, for ParaView.

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/store/result_file.hpp"

namespace couplet::flow {

struct StationField {
  std::string name;
  std::string unit;
  Eigen::ArrayXd values;  // (n_stations)
};

/// results/flow.h5 and results/flow.xmf: one polyline along x, moved by its displacement.
class StationResults {
 public:
  /// Stations stand at `position` [m] at first. When the files are there and time > 0, they are continued.
  StationResults(const std::filesystem::path& results_folder, Eigen::ArrayXd position, double time);

  void append(double time, const Eigen::ArrayXd& position, const std::vector<StationField>& fields);

 private:
  Eigen::ArrayXd first_position_;
  store::ResultWriter writer_;
};

}  // namespace couplet::flow
