#include "solid-server/dynamics/substep_limit.hpp"

#include <algorithm>

#include "solid-server/dynamics/stable_step.hpp"

namespace couplet::solid {

namespace {

// An estimate takes some 20 to 30 evaluations of all forces.
constexpr int n_substeps_to_wait = 1000;
constexpr double change_that_never_waits = 0.25;

double smallest_edge(const SolidMesh& mesh) {
  double smallest = std::numeric_limits<double>::max();
  for (const ElementBlock& block : mesh.block)
    for (Index element = 0; element < block.n_elements(); ++element)
      for (const auto& [a, b] : topology(block.shape).edge) {
        if (a < 0) continue;
        const auto corner = [&](int c) {
          return mesh.node_position.row(block.nodes_of(element)[static_cast<std::size_t>(c)]);
        };
        smallest = std::min(smallest, (corner(b) - corner(a)).norm());
      }
  return smallest;
}

bool has_fibres(const BlockProperties& properties) {
  return std::visit([](const auto& law) { return law.is_anisotropic; }, properties.material);
}

}  // namespace

SubstepLimit::SubstepLimit(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, NodalForce& force,
                           const NodeVectors& inverse_mass, double stiffness_damping, const StepControl& control,
                           WorkTeam& team)
    : force_(force),
      inverse_mass_(inverse_mass),
      stiffness_damping_(stiffness_damping),
      control_(control),
      team_(team),
      length_change_(mesh),
      smallest_length_(smallest_edge(mesh)),
      contact_rate_squared_(
          force.external().contact_stiffness_bound().cwiseProduct(inverse_mass.rowwise().maxCoeff()).maxCoeff()),
      may_wait_(std::none_of(properties.begin(), properties.end(), has_fibres)) {}

/// What the safety leaves room for: at the default of 0.9, 6 % of length, where a step may shrink by 9 %.
double SubstepLimit::free_change() const {
  return std::max(0.0, 0.6 * (1 - control_.safety));
}

double SubstepLimit::largest(const StepEstimate& estimate) const {
  const double ratio = std::min(1.0, (1 + free_change()) / (1 + estimate.change));
  const double largest = control_.safety * estimate.stable_step * ratio * ratio;
  return control_.largest_substep > 0 ? std::min(largest, control_.largest_substep) : largest;
}

StepEstimate SubstepLimit::estimate_at(const NodeVectors& displacement) {
  StepEstimate estimate;
  estimate.stable_step =
      stable_step([&](const NodeVectors& u, NodeVectors& force) { force_.internal_only(u, team_, force); },
                  displacement, inverse_mass_, smallest_length_, contact_rate_squared_, team_, stiffness_damping_);
  estimate.displacement = std::make_shared<const NodeVectors>(displacement);
  return estimate;
}

void SubstepLimit::look(const NodeVectors& displacement, StepEstimate& estimate) {
  if (estimate.n_unseen < n_between_looks) return;
  std::vector<double> change(static_cast<std::size_t>(team_.n_members()));
  team_.run([&](int member) {
    change[static_cast<std::size_t>(member)] =
        length_change_.largest(*estimate.displacement, displacement, member, team_.n_members());
  });
  estimate.change = *std::max_element(change.begin(), change.end());
  estimate.n_unseen = 0;
  if (estimate.change <= free_change()) return;
  if (may_wait_ && estimate.n_substeps < n_substeps_to_wait && estimate.change < change_that_never_waits) return;
  estimate = estimate_at(displacement);
}

void SubstepLimit::accept(const NodeVectors& displacement, StepEstimate& estimate) {
  if (++estimate.n_accepted >= control_.estimate_every)
    estimate = estimate_at(displacement);
  else
    look(displacement, estimate);
}

}  // namespace couplet::solid
