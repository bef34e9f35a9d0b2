#include "proto/scene/marker_rules.hpp"
#include "proto/scene/relation_rules.hpp"

namespace couplet::scene {

namespace {

const std::string glottis_path = "flow.glottis";

void glottis_has_one_channel(const v1::Scene& scene, Review& review) {
  const bool has_channel = scene.flow().glottis().has_channel();
  if (has_channel && scene.has_solid()) {
    review.complain(glottis_path + ".channel",
                    "contradicts solid, whose surface is the channel already; delete channel or solid");
  }
  if (!has_channel && !scene.has_solid()) {
    review.complain_missing(glottis_path + ".channel",
                            "is missing in a scene without solid; give channel { ... } or solid { ... }");
  }
}

void solid_touches_the_flow(const v1::Scene& scene, Review& review) {
  for (int i = 0; i < scene.solid().body_size(); ++i) {
    if (scene.solid().body(i).wetted_size() > 0) return;
  }
  if (scene.solid().body_size() == 0) return;
  review.complain_missing("solid.body[0].wetted",
                          "is missing; name the surfaces that touch the flow, for example wetted: [\"medial\"]");
}

void glottis_knows_its_folds(const v1::Scene& scene, Review& review) {
  const v1::Glottis& glottis = scene.flow().glottis();
  if (!glottis.has_midplane()) {
    review.complain_missing(glottis_path + ".midplane",
                            "is missing; give in m the position y of the plane midway between the folds");
  }
  if (!glottis.has_exit_line()) {
    review.complain_missing(
        glottis_path + ".exit_line",
        "is missing; give the material line of the exit, for example exit_line { marker: \"superior_fillet_middle\" }");
  }
  if (glottis.model() == v1::Glottis::M2 && glottis.has_model() && !glottis.has_entrance_start()) {
    review.complain_missing(
        glottis_path + ".entrance_start",
        "is missing, but M2 needs it; give entrance_start { marker: \"inferior_middle\" } or choose model M1");
  }
  check_marker(glottis.entrance_start(), glottis_path + ".entrance_start", scene.solid(), review);
  check_marker(glottis.exit_line(), glottis_path + ".exit_line", scene.solid(), review);
}

void halves_agree(const v1::Scene& scene, Review& review) {
  const v1::Glottis& glottis = scene.flow().glottis();
  for (const v1::Body& body : scene.solid().body()) {
    if (!body.has_vocal_fold() || body.vocal_fold().half_length() == glottis.half_length()) continue;
    const std::string of_fold = body.vocal_fold().half_length() ? "true" : "false";
    review.complain(glottis_path + ".half_length", std::string(glottis.half_length() ? "true" : "false") +
                                                       " contradicts half_length of the vocal fold, " + of_fold +
                                                       "; set both to " + of_fold);
  }
}

}  // namespace

void check_flow_rules(const v1::Scene& scene, Review& review) {
  const bool is_coupled = scene.has_flow() && scene.has_solid();
  if (is_coupled) solid_touches_the_flow(scene, review);
  if (scene.flow().has_navier_stokes()) {
    check_navier_stokes_rules(scene, review);
    check_flow_body_rules(scene, review);
  }
  if (!scene.flow().has_glottis()) return;
  glottis_has_one_channel(scene, review);
  if (!is_coupled) return;
  glottis_knows_its_folds(scene, review);
  halves_agree(scene, review);
}

}  // namespace couplet::scene
