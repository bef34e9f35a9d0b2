#pragma once
// How the fields that travel are stacked into vectors on the solid's nodes.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "proto/participant/participant.hpp"

namespace couplet::coupling {

/// One field in a stacked vector, node by node: (n_nodes * n_components) entries from `offset`.
struct Segment {
  std::string name;
  std::string unit;
  int n_components = 0;
  Eigen::Index offset = 0, size = 0;
};

/// Motion is what the solid gives to the flow, load what the flow gives to the solid. Any names are possible; force,
/// displacement and velocity are mapped between surfaces that differ, others need surfaces with the same nodes.
struct InterfaceLayout {
  std::vector<Segment> motion, load;
  Eigen::Index n_primary_motion =
      0;  // leading entries of the motion that determine it; a velocity follows its displacement

  Eigen::Index n_motion() const { return motion.back().offset + motion.back().size; }
  Eigen::Index n_load() const { return load.back().offset + load.back().size; }
  Eigen::Index n_secondary_motion() const { return n_motion() - n_primary_motion; }
};

/// The plan from what each participant needs and offers. Throws SceneError when a need is not offered by the other, or
/// when there is nothing to exchange in one direction.
InterfaceLayout make_interface_layout(const participant::Opened& flow, const participant::Opened& solid);

/// Motion and load at one time, stacked.
struct InterfaceState {
  Eigen::VectorXd motion;  // (n_motion)
  Eigen::VectorXd load;    // (n_load)
};

}  // namespace couplet::coupling
