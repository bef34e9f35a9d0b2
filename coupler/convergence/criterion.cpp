#include "coupler/convergence/criterion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace couplet::coupling {

FieldChange measure_change(const Eigen::Ref<const Eigen::VectorXd>& before,
                           const Eigen::Ref<const Eigen::VectorXd>& after, int n_components) {
  double largest_squared = 0, change_squared = 0, field_squared = 0;
  for (Eigen::Index node = 0; node < after.size(); node += n_components) {
    double node_squared = 0;
    for (Eigen::Index entry = node; entry < node + n_components; ++entry) {
      const double change = after(entry) - before(entry);
      node_squared += change * change;
      field_squared += after(entry) * after(entry);
    }
    change_squared += node_squared;
    if (!(node_squared <= largest_squared)) largest_squared = node_squared;  // also takes a not-a-number
  }
  const double relative = change_squared == 0 ? 0 : std::sqrt(change_squared) / std::sqrt(field_squared);
  return {std::sqrt(largest_squared), relative};
}

bool has_converged(const Criterion& criterion, const FieldChange& change) {
  return excess(criterion, change) <= 1;
}

double excess(const Criterion& criterion, const FieldChange& change) {
  double smallest = std::numeric_limits<double>::infinity();
  if (!std::isfinite(change.absolute) || !std::isfinite(change.relative)) return smallest;
  if (criterion.absolute) smallest = std::min(smallest, change.absolute / *criterion.absolute);
  if (criterion.relative) smallest = std::min(smallest, change.relative / *criterion.relative);
  return smallest;
}

}  // namespace couplet::coupling
