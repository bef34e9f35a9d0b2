#include "solid-server/support/prescribed_motion.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "proto/report/failure.hpp"

namespace couplet::solid {

HeldMotion::HeldMotion(const SolidMesh& mesh, const std::vector<PrescribedMotion>& motions) : motions_(motions) {
  std::map<std::pair<Index, int>, std::size_t> motion_of;
  for (std::size_t m = 0; m < motions.size(); ++m)
    for (const Index node :
         mesh.find_nodes(motions[m].nodes, "solid.prescribed_motion[" + std::to_string(m) + "].nodes"))
      motion_of.try_emplace({node, motions[m].axis}, m);
  for (const auto& [component, motion] : motion_of) {
    components_.push_back({component.first, component.second});
    position_.push_back(mesh.node_position.row(component.first));
    motion_.push_back(motion);
  }
}

std::optional<std::size_t> HeldMotion::number_of(const Component& component) const {
  const auto key = [](const Component& c) { return std::pair{c.node, c.axis}; };
  const auto found = std::lower_bound(components_.begin(), components_.end(), component,
                                      [&](const Component& a, const Component& b) { return key(a) < key(b); });
  if (found == components_.end() || key(*found) != key(component)) return std::nullopt;
  return static_cast<std::size_t>(found - components_.begin());
}

double HeldMotion::displacement(std::size_t n, double time) const {
  return motions_[motion_[n]].displacement(position_[n], time);
}

double HeldMotion::velocity(std::size_t n, double time, double step) const {
  return (displacement(n, time + step / 2) - displacement(n, time - step / 2)) / step;
}

double HeldMotion::acceleration(std::size_t n, double time, double step) const {
  return (displacement(n, time + step) - 2 * displacement(n, time) + displacement(n, time - step)) / (step * step);
}

void HeldMotion::check_finite(double time) const {
  for (std::size_t n = 0; n < components_.size(); ++n) {
    const double value = displacement(n, time);
    if (std::isfinite(value)) continue;
    throw report::NumericsError(
        "solid.prescribed_motion \"" + motions_[motion_[n]].nodes + "\", t = " + report::text(time) + " s",
        "the formula of " + std::string(1, "xyz"[components_[n].axis]) + " gives " + report::text(value) + " at " +
            place_text(position_[n]),
        "mend it: its value must be finite at all times");
  }
}

void HeldMotion::refuse_jump_at_start(double negligible) const {
  for (std::size_t n = 0; n < components_.size(); ++n) {
    const double value = displacement(n, 0);
    if (std::abs(value) <= negligible || !std::isfinite(value)) continue;
    throw report::SceneError("solid.prescribed_motion \"" + motions_[motion_[n]].nodes + "\"",
                             "the formula of " + std::string(1, "xyz"[components_[n].axis]) + " gives " +
                                 report::text(value) + " m at t = 0 at " + place_text(position_[n]) +
                                 ", where the body is at rest: a blow without end",
                             "let the motion begin at 0, or use method: STATIC");
  }
}

void HeldMotion::hold(double time, NodeVectors& u) const {
  for (std::size_t n = 0; n < components_.size(); ++n)
    u(components_[n].node, components_[n].axis) = displacement(n, time);
}

void HeldMotion::hold_velocity(double time, double step, NodeVectors& v) const {
  for (std::size_t n = 0; n < components_.size(); ++n)
    v(components_[n].node, components_[n].axis) = velocity(n, time, step);
}

void HeldMotion::hold_acceleration(double time, double step, NodeVectors& a) const {
  for (std::size_t n = 0; n < components_.size(); ++n)
    a(components_[n].node, components_[n].axis) = acceleration(n, time, step);
}

}  // namespace couplet::solid
