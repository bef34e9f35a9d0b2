#include "solid-server/dynamics/energy_ledger.hpp"

#include <numeric>

namespace couplet::solid {

EnergyLedger::NodeParts::NodeParts(Index n_nodes, const std::vector<ForcePart>& parts)
    : first(static_cast<std::size_t>(n_nodes) + 1, 0), start(parts.size()) {
  for (const ForcePart& part : parts) ++first[static_cast<std::size_t>(part.node) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Index> next(first.begin(), first.end() - 1);
  for (const ForcePart& part : parts)
    start[static_cast<std::size_t>(next[static_cast<std::size_t>(part.node)]++)] = part.start;
}

EnergyLedger::EnergyLedger(const ExternalForce& external, const Eigen::VectorXd& mass, const NodeVectors& inverse_mass,
                           double stiffness_factor)
    : load_(static_cast<Index>(mass.size()), external.load_parts()),
      all_(static_cast<Index>(mass.size()), external.parts()),
      free_mass_(mass.asDiagonal() * (inverse_mass.array() > 0).cast<double>().matrix()),
      stiffness_factor_(stiffness_factor),
      sums_(decltype(sums_)::Zero(mass.size(), 2)) {}

void EnergyLedger::act_on_held(Index node, int axis, double force, double drift, double velocity_change,
                               const double* parts) {
  sums_(node, work_at) += (load_.sum(node, parts)[axis] - force) * drift;
  sums_(node, damping_at) += stiffness_factor_ * (force - all_.sum(node, parts)[axis]) * velocity_change;
}

std::size_t EnergyLedger::memory_bytes() const {
  const std::size_t n_indices = load_.first.size() + load_.start.size() + all_.first.size() + all_.start.size();
  return n_indices * sizeof(Index) + static_cast<std::size_t>(free_mass_.size() + sums_.size()) * sizeof(double);
}

}  // namespace couplet::solid
