#pragma once
// What a part of the coupler must remember over a restart, as named arrays.

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace couplet::coupling {

/// Restoring it must give equal bits; numbers and counts are arrays of one entry.
using SavedState = std::map<std::string, Eigen::MatrixXd>;

inline Eigen::MatrixXd to_array(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

inline std::vector<double> to_numbers(const Eigen::MatrixXd& array) {
  return {array.data(), array.data() + array.size()};
}

}  // namespace couplet::coupling
