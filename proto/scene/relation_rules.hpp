#pragma once
// Rules between fields, that no single field can declare.

#include "couplet/v1/scene.pb.h"
#include "proto/scene/review.hpp"

namespace couplet::scene {

/// All of the rules below.
void check_relations(const v1::Scene& scene, Review& review);

void check_time_rules(const v1::Scene& scene, Review& review);           // span, step, time tables
void check_solid_rules(const v1::Scene& scene, Review& review);          // surfaces, meshes, bodies
void check_solid_load_rules(const v1::Scene& scene, Review& review);     // directions, motions, equilibria
void check_flow_rules(const v1::Scene& scene, Review& review);           // glottis with and without a solid
void check_navier_stokes_rules(const v1::Scene& scene, Review& review);  // grid, borders, what is measured
void check_flow_body_rules(const v1::Scene& scene, Review& review);      // bodies in that flow: shapes, motions
void check_coupling_rules(const v1::Scene& scene, Review& review);       // scheme, acceleration, convergence
void check_output_rules(const v1::Scene& scene, Review& review);         // probes, quantities, results

}  // namespace couplet::scene
