// Rules between fields of the solid: exact lines.

#include <gmock/gmock.h>

#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A scene of a solid alone.
std::string solid_scene(const std::string& solid) {
  return "title: \"a\"\ntime { end: 1  step: 0.1 }\nsolid {\n" + solid + "\n}\n";
}

const std::string material = "material { density: 1000 neo_hookean { shear_modulus: 1e4 bulk_modulus: 1e6 } }";

std::string box_body(const std::string& name, const std::string& more = material) {
  return "body { name: \"" + name + "\" box { length { x: 1 y: 1 z: 1 } } " + more + " }";
}

TEST(SolidRules, NameSurfacesOfSeveralBodiesByTheirBody) {
  const std::string bodies = box_body("lower") + "\n" + box_body("upper") + "\n";
  EXPECT_THAT(complaints_about(solid_scene(bodies + "contact { first: \"lower/y_max\" second: \"upper/y_min\" }")),
              IsEmpty());
  EXPECT_THAT(
      complaints_about(solid_scene(bodies + "contact { first: \"y_max\" second: \"upper/y_mni\" }")),
      ElementsAre("scene.txtpb:6:11: solid.contact[0].first: the mesh has no surface \"y_max\"; it has lower/x_min, "
                  "lower/x_max, lower/y_min, lower/y_max, lower/z_min, lower/z_max, upper/x_min, upper/x_max, "
                  "upper/y_min, upper/y_max, upper/z_min, upper/z_max",
                  "scene.txtpb:6:26: solid.contact[0].second: the mesh has no surface \"upper/y_mni\"; did you "
                  "mean upper/y_min?"));
}

TEST(SolidRules, RefuseContactOfTheSameSurfacesTwice) {
  const std::string bodies = box_body("lower") + "\n" + box_body("upper") + "\n";
  EXPECT_THAT(complaints_about(solid_scene(bodies + "contact { first: \"lower/y_max\" second: \"upper/y_min\" }\n"
                                                    "contact { first: \"upper/y_min\" second: \"lower/y_max\" }")),
              ElementsAre("scene.txtpb:7:1: solid.contact[1]: names the surfaces of solid.contact[0] again; give one "
                          "contact, with the stiffness that is wanted"));
}

TEST(SolidRules, WantAMaterialForEveryBody) {
  EXPECT_THAT(complaints_about(solid_scene(box_body("a", ""))),
              ElementsAre("scene.txtpb:4:1: solid.body[0].material: is missing; give what the body is made of"));
}

TEST(SolidRules, RefuseRegionsThatTheMeshDoesNotHave) {
  const std::string leaflet = "region { name: \"leaflet_4\" " + material + " }";
  EXPECT_THAT(
      complaints_about(solid_scene("body { name: \"valve\" valve { } " + material + " " + leaflet + " }")),
      ElementsAre(testing::HasSubstr("solid.body[0].region[0].name: the mesh has no region \"leaflet_4\"; it has "
                                     "leaflet_1, leaflet_2, leaflet_3")));
  EXPECT_THAT(complaints_about(solid_scene(box_body("a", material + " " + leaflet))),
              ElementsAre(testing::HasSubstr("the mesh has no region \"leaflet_4\"; it names none")));
}

TEST(SolidRules, WantFibresForLawsThatHaveSome) {
  const std::string law = "material { density: 1 may_newman { c0: 1 c1: 1 c2: 1 bulk_modulus: 1e3 } }";
  EXPECT_THAT(
      complaints_about(solid_scene(box_body("a", law))),
      ElementsAre("scene.txtpb:4:52: solid.body[0].material: the law has fibres, but the body does not say where "
                  "they run; give fibres { ... }"));
  EXPECT_THAT(complaints_about(solid_scene(box_body("a", law + " fibres { circumferential { axis { x: 1 } } }"))),
              IsEmpty());
  EXPECT_THAT(complaints_about(solid_scene("body { name: \"valve\" valve { } " + law + " }")), IsEmpty());
}

TEST(SolidRules, RefuseToAverageALawWithoutVolumetricPart) {
  const std::string law =
      "material { density: 1 saint_venant_kirchhoff { young_modulus: 1 poisson_ratio: 0.3 } } near_incompressible: "
      "true";
  EXPECT_THAT(
      complaints_about(solid_scene(box_body("a", law))),
      ElementsAre("scene.txtpb:4:74: solid.body[0].material.saint_venant_kirchhoff: has no volumetric part that "
                  "near_incompressible could average; use neo_hookean or mooney_rivlin"));
}

TEST(SolidRules, RefuseAWallWithoutThickness) {
  EXPECT_THAT(
      complaints_about(
          solid_scene("body { name: \"a\" annulus { inner_radius: 2 outer_radius: 1 length: 1 } " + material + " }")),
      ElementsAre("scene.txtpb:4:44: solid.body[0].annulus.outer_radius: 1 m is not above the inner radius, 2 m; "
                  "give a larger one"));
}

TEST(SolidRules, NameLoadedNodes) {
  EXPECT_THAT(complaints_about(solid_scene(
                  box_body("a") + " prescribed_motion { nodes: \"tip\" y: \"0.1*t\" } node_force { nodes: "
                                  "\"x_max\" value { direction { y: 1 } value { row { time: 0 value: 1 } } } }")),
              ElementsAre(testing::HasSubstr("solid.prescribed_motion[0].nodes: the mesh has no surface, node set or "
                                             "marker \"tip\"; it has x_min, x_max, y_min, y_max, z_min, z_max")));
}

const std::string held_body = box_body("a", material + " fixed: \"x_min\"");

TEST(SolidRules, WantColumnsWithNamesOfTheirOwn) {
  const std::string orifice = R"(orifice { name: "%" surface: "x_max" radius: 1 })";
  const auto named = [&](const std::string& name) {
    std::string text = orifice;
    return text.replace(text.find('%'), 1, name);
  };
  EXPECT_THAT(
      complaints_about(solid_scene(box_body("a") + named("open") + "\n" + named("open") + "\n" + named("time"))),
      ElementsAre(testing::HasSubstr("solid.orifice[1].name: \"open\" is another column of history.csv; give the "
                                     "orifice its own name"),
                  testing::HasSubstr("solid.orifice[2].name: \"time\" is another column")));
}

TEST(SolidRules, RefuseDirectionsWithoutLength) {
  const std::string zero = " direction { } value { row { time: 0 value: 1 } } ";
  EXPECT_THAT(
      complaints_about(solid_scene(held_body + "\ntraction { surface: \"x_max\" value {" + zero +
                                   "} }\nnode_force { nodes: \"x_max\" value {" + zero + "} }\ngravity {" + zero +
                                   "}\nrigid_plane { surface: \"y_max\" plane { point { } normal { } } }")),
      ElementsAre("scene.txtpb:5:37: solid.traction[0].value.direction: all components are 0; give a direction, for "
                  "example { x: 1 }",
                  "scene.txtpb:6:37: solid.node_force[0].value.direction: all components are 0; give a direction, for "
                  "example { x: 1 }",
                  "scene.txtpb:7:11: solid.gravity.direction: all components are 0; give a direction, for example "
                  "{ x: 1 }",
                  "scene.txtpb:8:50: solid.rigid_plane[0].plane.normal: all components are 0; give a direction, for "
                  "example { x: 1 }"));
}

TEST(SolidRules, RefuseAMotionWithoutComponents) {
  EXPECT_THAT(
      complaints_about(solid_scene(held_body + "\nprescribed_motion { nodes: \"x_max\" }")),
      ElementsAre("scene.txtpb:5:1: solid.prescribed_motion[0]: has no component; give x, y or z, or delete it"));
}

TEST(SolidRules, WantSupportsAndNoVelocitiesInEquilibrium) {
  const std::string equilibrium = "\ntime_integration { method: STATIC }";
  EXPECT_THAT(complaints_about(solid_scene(box_body("a") + equilibrium)),
              ElementsAre("scene.txtpb:4:1: solid.body[0]: nothing holds the body, so that it has no equilibrium; give "
                          "fixed, symmetry or prescribed_motion, or another time_integration.method than STATIC"));
  EXPECT_THAT(complaints_about(solid_scene(held_body + equilibrium)), IsEmpty());
  EXPECT_THAT(
      complaints_about(solid_scene(box_body("a") + equilibrium + "\nprescribed_motion { nodes: \"x_max\" x: \"t\" }")),
      IsEmpty());
  EXPECT_THAT(complaints_about(solid_scene(box_body("a") + equilibrium + "\ncontact { first: \"x_max\" }")), IsEmpty());
  EXPECT_THAT(
      complaints_about(solid_scene(held_body + equilibrium + "\nkick { time: 0 velocity { } }")),
      ElementsAre("scene.txtpb:6:1: solid.kick[0]: an equilibrium has no velocities; delete it, or give another "
                  "time_integration.method than STATIC"));
}

TEST(SolidRules, WantABoxWithAVolume) {
  EXPECT_THAT(
      complaints_about(solid_scene("body { name: \"a\" box { length { x: 1 y: -2 } } " + material + " }")),
      testing::UnorderedElementsAre(
          "scene.txtpb:4:38: solid.body[0].box.length.y: -2 m is not above 0; give the length of the box along y",
          "scene.txtpb:4:24: solid.body[0].box.length.z: 0 m is not above 0; give the length of the box along z"));
}

}  // namespace
}  // namespace couplet::scene
