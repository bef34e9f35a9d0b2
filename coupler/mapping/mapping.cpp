#include "coupler/mapping/mapping.hpp"

#include <cassert>
#include <utility>

#include "coupler/mapping/closest_face.hpp"
#include "coupler/mapping/matching.hpp"
#include "coupler/mapping/nearest_point.hpp"
#include "proto/report/failure.hpp"

namespace couplet::coupling {

namespace {

using surface::NodeArray;

const std::string scene_field = "coupling.mapping";

void check_nodes(const surface::SurfaceMesh& mesh, const std::string& side) {
  if (mesh.n_nodes() == 0)
    throw report::SceneError(scene_field, "the surface of the " + side + " has no nodes",
                             "check which faces of the " + side + " are the interface");
}

/// Arms act on vector fields whose displacement is known; fields of one component know no direction.
bool has_arms(const Interpolation& interpolation, const NodeArray& field, const NodeArray& displacement) {
  return !interpolation.arms.empty() && field.cols() == 3 && displacement.cols() == 3;
}

}  // namespace

std::string name_of(MappingKind kind) {
  switch (kind) {
    case MappingKind::automatic:
      return "automatic";
    case MappingKind::matching:
      return "matching";
    case MappingKind::nearest_point:
      return "nearest point";
    case MappingKind::closest_face:
      return "closest face";
  }
  return "";
}

Mapping::Mapping(const surface::SurfaceMesh& flow, const surface::SurfaceMesh& solid, MappingKind kind)
    : flow_position_(flow.node_position), solid_position_(solid.node_position), kind_(kind) {
  check_nodes(flow, "flow");
  check_nodes(solid, "solid");
  if (kind_ == MappingKind::automatic || kind_ == MappingKind::matching) {
    MatchingResult matching = match_nodes(flow, solid);
    if (matching.interpolation) {
      kind_ = MappingKind::matching;
      is_identity_ = matching.is_identity;
      interpolation_ = std::move(*matching.interpolation);
      return;
    }
    if (kind_ == MappingKind::matching)
      throw report::SceneError(scene_field, "MATCHING: " + matching.first_unmatched, "use CLOSEST_FACE or AUTOMATIC");
    kind_ = solid.n_faces() > 0 ? MappingKind::closest_face : MappingKind::nearest_point;
  }
  if (kind_ == MappingKind::closest_face && solid.n_faces() == 0)
    throw report::SceneError(scene_field, "CLOSEST_FACE: the surface of the solid has nodes but no faces",
                             "use NEAREST_POINT or AUTOMATIC");
  interpolation_ =
      kind_ == MappingKind::closest_face ? follow_closest_faces(flow, solid) : follow_nearest_nodes(flow, solid);
}

NodeArray Mapping::displacement_to_flow(const NodeArray& solid_displacement) const {
  assert(solid_displacement.rows() == solid_position_.rows());
  if (is_identity_) return solid_displacement;
  NodeArray result = interpolation_.weights * solid_displacement;
  if (!has_arms(interpolation_, result, solid_displacement)) return result;
  for (const NormalArm& arm : interpolation_.arms) {
    const Eigen::Vector3d turn = arm_normal(arm, solid_position_, solid_displacement) - arm.reference_normal;
    result.row(arm.flow_node).head<3>() += arm.gap * turn.transpose();
  }
  return result;
}

NodeArray Mapping::velocity_to_flow(const NodeArray& solid_velocity, const NodeArray& solid_displacement) const {
  assert(solid_velocity.rows() == solid_position_.rows());
  if (is_identity_) return solid_velocity;
  NodeArray result = interpolation_.weights * solid_velocity;
  if (!has_arms(interpolation_, result, solid_displacement)) return result;
  for (const NormalArm& arm : interpolation_.arms)
    result.row(arm.flow_node).head<3>() +=
        arm_velocity(arm, solid_position_, solid_displacement, solid_velocity).transpose();
  return result;
}

NodeArray Mapping::force_to_solid(const NodeArray& flow_force, const NodeArray& solid_displacement) const {
  assert(flow_force.rows() == flow_position_.rows());
  if (is_identity_) return flow_force;
  NodeArray result = interpolation_.weights.transpose() * flow_force;
  if (!has_arms(interpolation_, result, solid_displacement)) return result;
  for (const NormalArm& arm : interpolation_.arms)
    add_arm_force(arm, solid_position_, solid_displacement, flow_force.row(arm.flow_node).head<3>().transpose(),
                  result);
  return result;
}

ConservationError Mapping::conservation_error(const NodeArray& flow_force, const NodeArray& solid_force,
                                              const NodeArray& solid_displacement,
                                              const NodeArray& solid_motion) const {
  const InterfaceSide solid{solid_force, solid_position_, solid_displacement, solid_motion};
  if (is_identity_) return compare_sides({flow_force, flow_position_, solid_displacement, solid_motion}, solid);
  NodeArray flow_displacement, flow_motion;
  if (solid_displacement.rows() == solid_position_.rows()) flow_displacement = displacement_to_flow(solid_displacement);
  if (solid_motion.rows() == solid_position_.rows()) flow_motion = velocity_to_flow(solid_motion, solid_displacement);
  return compare_sides({flow_force, flow_position_, flow_displacement, flow_motion}, solid);
}

}  // namespace couplet::coupling
