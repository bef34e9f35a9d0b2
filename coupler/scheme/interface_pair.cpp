#include "coupler/scheme/interface_pair.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"

namespace couplet::coupling {

namespace {

using Eigen::VectorXd;
using surface::Field;
using surface::FieldSet;
using surface::NodeArray;

NodeArray unstack(const VectorXd& stacked, const Segment& segment) {
  return Eigen::Map<const NodeArray>(stacked.data() + segment.offset, segment.size / segment.n_components,
                                     segment.n_components);
}

void stack(const NodeArray& values, const Segment& segment, const std::string& whose, VectorXd& stacked) {
  if (values.size() != segment.size || values.cols() != segment.n_components) {
    throw report::PeerError(whose,
                            "the field '" + segment.name + "' has shape (" + std::to_string(values.rows()) + ", " +
                                std::to_string(values.cols()) + ") instead of (" +
                                std::to_string(segment.size / segment.n_components) + ", " +
                                std::to_string(segment.n_components) + ")",
                            "mend the program that offers it: the shape must stay as it was when the scene was opened");
  }
  stacked.segment(segment.offset, segment.size) = Eigen::Map<const VectorXd>(values.data(), values.size());
}

FieldSet empty_fields(const std::vector<Segment>& segments) {
  FieldSet fields;
  for (const Segment& segment : segments) fields.push_back({segment.name, segment.unit, {}});
  return fields;
}

bool is_standard(const std::string& name) {
  return name == "force" || name == "displacement" || name == "velocity";
}

void refuse_unknown_on_different_surfaces(const InterfaceLayout& layout, const Mapping& mapping) {
  if (mapping.kind() == MappingKind::matching) return;
  for (const auto* segments : {&layout.motion, &layout.load}) {
    for (const Segment& segment : *segments) {
      if (is_standard(segment.name)) continue;
      throw report::SceneError(
          "coupling.mapping", "the field '" + segment.name + "' cannot be mapped between surfaces with different nodes",
          "give both programs the same nodes, or exchange force, displacement and velocity");
    }
  }
}

}  // namespace

InterfacePair::InterfacePair(participant::Participant& flow, participant::Participant& solid,
                             const participant::Opened& flow_opened, const participant::Opened& solid_opened,
                             MappingKind mapping)
    : flow_(flow),
      solid_(solid),
      n_flow_nodes_(flow_opened.surface.n_nodes()),
      layout_(make_interface_layout(flow_opened, solid_opened)),
      mapping_(flow_opened.surface, solid_opened.surface, mapping),
      for_flow_(empty_fields(layout_.motion)),
      for_solid_(empty_fields(layout_.load)),
      displacement_(NodeArray::Zero(solid_opened.surface.n_nodes(), 3)),
      rate_(NodeArray::Zero(solid_opened.surface.n_nodes(), 3)) {
  refuse_unknown_on_different_surfaces(layout_, mapping_);
  start_.motion = motion_from_solid(solid_opened.fields);
  motion_to_flow(start_.motion);
  start_.load = load_from_flow(flow_opened.fields);
  largest_error_ = {};
}

VectorXd InterfacePair::solve_flow(const participant::StepInterval& interval, const VectorXd& motion) {
  return load_from_flow(flow_.solve_step(interval, motion_to_flow(motion)).fields);
}

VectorXd InterfacePair::solve_solid(const participant::StepInterval& interval, const VectorXd& load) {
  return motion_from_solid(solid_.solve_step(interval, load_to_solid(load)).fields);
}

InterfaceState InterfacePair::solve_both(const participant::StepInterval& interval, const InterfaceState& state) {
  flow_.start_step(interval, motion_to_flow(state.motion));
  solid_.start_step(interval, load_to_solid(state.load));
  participant::StepSolved flow;
  try {
    flow = flow_.finish_step();
  } catch (const report::NumericsError&) {
    solid_.finish_step();  // its answer must not be taken for one to a later request
    throw;
  }
  const participant::StepSolved solid = solid_.finish_step();
  return {motion_from_solid(solid.fields), load_from_flow(flow.fields)};
}

const FieldSet& InterfacePair::motion_to_flow(const VectorXd& motion) {
  for (const Segment& segment : layout_.motion) {
    if (segment.name == "displacement") displacement_ = unstack(motion, segment);
    if (segment.name == "velocity") rate_ = unstack(motion, segment);
  }
  for (std::size_t k = 0; k < layout_.motion.size(); ++k) {
    const Segment& segment = layout_.motion[k];
    NodeArray values = segment.name == "displacement" ? displacement_ : unstack(motion, segment);
    if (mapping_.is_identity()) {
      for_flow_[k].values = std::move(values);
    } else if (segment.name == "velocity") {
      for_flow_[k].values = mapping_.velocity_to_flow(values, displacement_);
    } else {
      for_flow_[k].values = mapping_.displacement_to_flow(values);
    }
  }
  return for_flow_;
}

const FieldSet& InterfacePair::load_to_solid(const VectorXd& load) {
  for (std::size_t k = 0; k < layout_.load.size(); ++k) for_solid_[k].values = unstack(load, layout_.load[k]);
  return for_solid_;
}

VectorXd InterfacePair::load_from_flow(const FieldSet& fields) {
  VectorXd load(layout_.n_load());
  for (const Segment& segment : layout_.load) {
    const NodeArray& values = surface::find_field(fields, segment.name).values;
    if (mapping_.is_identity()) {
      stack(values, segment, "flow", load);
      continue;
    }
    if (values.rows() != n_flow_nodes_) {
      throw report::PeerError("flow",
                              "the field '" + segment.name + "' has " + std::to_string(values.rows()) + " rows for " +
                                  std::to_string(n_flow_nodes_) + " nodes",
                              "mend the program that offers it");
    }
    const NodeArray mapped = mapping_.force_to_solid(values, displacement_);
    stack(mapped, segment, "flow", load);
    if (segment.name == "force") note_conservation(values, mapped);
  }
  return load;
}

VectorXd InterfacePair::motion_from_solid(const FieldSet& fields) const {
  VectorXd motion(layout_.n_motion());
  for (const Segment& segment : layout_.motion) {
    stack(surface::find_field(fields, segment.name).values, segment, "solid", motion);
  }
  return motion;
}

void InterfacePair::note_conservation(const NodeArray& flow_force, const NodeArray& solid_force) {
  const ConservationError error = mapping_.conservation_error(flow_force, solid_force, displacement_, rate_);
  largest_error_.force = std::max(largest_error_.force, error.force);
  largest_error_.moment = std::max(largest_error_.moment, error.moment);
  largest_error_.work = std::max(largest_error_.work, error.work);
}

}  // namespace couplet::coupling
