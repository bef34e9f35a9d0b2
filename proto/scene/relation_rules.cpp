#include "proto/scene/relation_rules.hpp"

namespace couplet::scene {

void check_relations(const v1::Scene& scene, Review& review) {
  if (!review.is_readable()) return;
  check_time_rules(scene, review);
  check_solid_rules(scene, review);
  check_solid_load_rules(scene, review);
  check_flow_rules(scene, review);
  check_coupling_rules(scene, review);
  check_output_rules(scene, review);
}

}  // namespace couplet::scene
