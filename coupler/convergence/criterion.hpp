#pragma once
// When an iteration has changed a field so little that the step is done.

#include <Eigen/Core>
#include <optional>
#include <string>

namespace couplet::coupling {

/// A field has converged when its change is below the absolute or the relative limit, whichever are given.
struct Criterion {
  std::string field;
  std::optional<double> absolute;  // largest change of any node (length of the vector) [unit of the field]
  std::optional<double> relative;  // 2-norm of the change over 2-norm of the field [1]
};

struct FieldChange {
  double absolute = 0;  // largest change of any node [unit of the field]
  double relative = 0;  // [1]
};

/// Change of a field stored node by node, (n_nodes * n_components).
FieldChange measure_change(const Eigen::Ref<const Eigen::VectorXd>& before,
                           const Eigen::Ref<const Eigen::VectorXd>& after, int n_components);

/// A change that is not a number has not converged.
bool has_converged(const Criterion& criterion, const FieldChange& change);

/// Change over what is allowed, 1 at the limit: how far from done.
double excess(const Criterion& criterion, const FieldChange& change);

}  // namespace couplet::coupling
