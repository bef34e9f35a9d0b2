#pragma once
// Flow and solid as two functions of stacked vectors on the solid's nodes; mapping and messages are hidden here.

#include <utility>

#include "coupler/mapping/mapping.hpp"
#include "coupler/scheme/interface_layout.hpp"
#include "proto/participant/participant.hpp"

namespace couplet::coupling {

class InterfacePair {
 public:
  /// Both must have been opened.
  InterfacePair(participant::Participant& flow, participant::Participant& solid, const participant::Opened& flow_opened,
                const participant::Opened& solid_opened, MappingKind mapping);

  const InterfaceLayout& layout() const { return layout_; }
  const Mapping& mapping() const { return mapping_; }

  /// What both offered when they were opened.
  const InterfaceState& start() const { return start_; }

  /// load = flow(motion), motion = solid(load): both at the end of the interval, from the last accepted state.
  Eigen::VectorXd solve_flow(const participant::StepInterval& interval, const Eigen::VectorXd& motion);
  Eigen::VectorXd solve_solid(const participant::StepInterval& interval, const Eigen::VectorXd& load);
  /// Both at the same time.
  InterfaceState solve_both(const participant::StepInterval& interval, const InterfaceState& state);

  /// Largest seen since the start, over all exchanges of force. Zero when no force is exchanged.
  const ConservationError& largest_conservation_error() const { return largest_error_; }
  void set_largest_conservation_error(const ConservationError& error) { largest_error_ = error; }

 private:
  const surface::FieldSet& motion_to_flow(const Eigen::VectorXd& motion);
  const surface::FieldSet& load_to_solid(const Eigen::VectorXd& load);
  Eigen::VectorXd load_from_flow(const surface::FieldSet& fields);
  Eigen::VectorXd motion_from_solid(const surface::FieldSet& fields) const;
  void note_conservation(const surface::NodeArray& flow_force, const surface::NodeArray& solid_force);

  participant::Participant& flow_;
  participant::Participant& solid_;
  std::int64_t n_flow_nodes_;
  InterfaceLayout layout_;
  Mapping mapping_;
  InterfaceState start_;
  surface::FieldSet for_flow_, for_solid_;  // sent, kept between steps
  surface::NodeArray displacement_, rate_;  // of the solid's nodes, as last given to the flow (n_solid, 3)
  ConservationError largest_error_;
};

}  // namespace couplet::coupling
