#include "solid-server/mesh/parametric/vocal_fold_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "proto/report/failure.hpp"
#include "solid-server/element/deformation.hpp"
#include "solid-server/mesh/wetted_surface.hpp"

namespace couplet::solid {
namespace {

VocalFoldShape fold(double medial_thickness, std::array<int, 3> n_elements) {
  VocalFoldShape shape;
  shape.section.medial_thickness = medial_thickness;
  shape.n_elements = n_elements;
  return shape;
}

void expect_at(const Eigen::Vector2d& point, double x_mm, double y_mm) {
  EXPECT_NEAR(point.x() * 1e3, x_mm, 1e-6);  // the digits of the calibrated geometry
  EXPECT_NEAR(point.y() * 1e3, y_mm, 1e-6);
}

TEST(FoldSection, HasTheCalibratedPointsForBothThicknesses) {
  const FoldSection thin = make_fold_section({.medial_thickness = 1.75e-3});
  expect_at(thin.B, 10.301997, 10);
  expect_at(thin.B1, 10.196732, 9.948401);
  expect_at(thin.B2, 10.417948, 10);
  expect_at(thin.C1, 12.167948, 10);
  expect_at(thin.C2, 12.667643, 9.517450);
  expect_at(thin.inferior_centre, 20.375999, -10.684791);
  EXPECT_NEAR(thin.inferior_radius * 1e3, 23.007522, 1e-6);
  const FoldSection thick = make_fold_section({.medial_thickness = 3.5e-3});
  expect_at(thick.B, 8.526652, 10);
  expect_at(thick.B1, 8.404801, 9.925151);
  expect_at(thick.inferior_centre, 19.488326, -7.981828);
}

TEST(FoldSection, RefusesAThicknessThatDoesNotFit) {
  EXPECT_THROW(make_fold_section({.medial_thickness = 13e-3}), report::SceneError);
}

double volume_at(const SolidMesh& mesh, Index element, const QuadraturePoint& point) {
  return reference_point(ElementShape::hexahedron20, at_element(mesh.node_position, mesh.nodes_of(element)), point)
      .volume;
}

class FoldMesh : public testing::TestWithParam<std::tuple<double, std::array<int, 3>>> {};

TEST_P(FoldMesh, HasNoFoldedElementAtAnyQuadraturePoint) {
  const auto [thickness, n_elements] = GetParam();
  const SolidMesh mesh = make_vocal_fold_mesh(fold(thickness, n_elements));
  for (const int n_points : {8, 14, 27})
    for (Index e = 0; e < mesh.n_elements(); ++e)
      for (const auto& point : element_quadrature(ElementShape::hexahedron20, n_points))
        ASSERT_GT(volume_at(mesh, e, point), 0);
}

TEST_P(FoldMesh, HasTheVolumeOfItsSection) {
  const auto [thickness, n_elements] = GetParam();
  const SolidMesh mesh = make_vocal_fold_mesh(fold(thickness, n_elements));
  double volume = 0;
  for (Index e = 0; e < mesh.n_elements(); ++e)
    for (const auto& point : element_quadrature(ElementShape::hexahedron20, 27)) volume += volume_at(mesh, e, point);
  const double section = (thickness < 2e-3 ? 87.736 : 94.822) * 1e-6;  // of the calibrated geometry [m^2]
  // A parabola through three points of the 88 degree fillet (radius 0.5 mm) is off by 0.01 mm over 0.7 mm.
  EXPECT_NEAR(volume / (section * 0.020), 1, 3e-4);
}

TEST_P(FoldMesh, HasEveryMarkerAtItsPoint) {
  const auto [thickness, n_elements] = GetParam();
  const SolidMesh mesh = make_vocal_fold_mesh(fold(thickness, n_elements));
  const FoldSection section = make_fold_section({.medial_thickness = thickness});
  const auto expect_marker = [&](const std::string& name, const Eigen::Vector2d& point) {
    const Eigen::Vector3d node = mesh.node_position.row(mesh.marker.at(name));
    EXPECT_LE((node - Eigen::Vector3d(point.x(), point.y(), 0.010)).norm(), 1e-12) << name;
  };
  expect_marker("B1", section.B1);
  expect_marker("B2", section.B2);
  expect_marker("C1", section.C1);
  expect_marker("C2", section.C2);
  expect_marker("medial_middle", (section.B2 + section.C1) / 2);
  expect_marker("inferior_middle", divide_arc(section.inferior_centre, section.A, section.B1, 2)[1]);
  expect_marker("superior_fillet_middle", divide_arc(section.superior_fillet_centre, section.C1, section.C2, 2)[1]);
}

INSTANTIATE_TEST_SUITE_P(Meshes, FoldMesh,
                         testing::Combine(testing::Values(1.75e-3, 3.5e-3),
                                          testing::Values(std::array{3, 4, 4}, std::array{4, 6, 8},
                                                          std::array{6, 9, 12}, std::array{8, 12, 16},
                                                          std::array{20, 25, 4})));

TEST(FoldMeshHalf, IsTheLowerHalfOfTheWhole) {
  VocalFoldShape shape = fold(1.75e-3, {6, 9, 12});
  const SolidMesh whole = make_vocal_fold_mesh(shape);
  shape.half_length = true;
  const SolidMesh half = make_vocal_fold_mesh(shape);
  EXPECT_EQ(2 * half.n_elements(), whole.n_elements());
  EXPECT_DOUBLE_EQ(half.node_position.col(2).maxCoeff(), 0.010);
  EXPECT_EQ(half.node_position, whole.node_position.topRows(half.n_nodes()));
  for (const Index node : nodes_of_faces(half, half.surface.at("posterior")))
    EXPECT_DOUBLE_EQ(half.node_position(node, 2), 0.010);
}

TEST(FoldMeshHalf, RefusesAnOddCountAlongTheLength) {
  VocalFoldShape shape = fold(1.75e-3, {6, 9, 11});
  shape.half_length = true;
  EXPECT_THROW(make_vocal_fold_mesh(shape), report::SceneError);
}

TEST(FoldMeshOffset, MovesEveryNodeAlongTheFlow) {
  VocalFoldShape shape = fold(1.75e-3, {4, 6, 8});
  const SolidMesh here = make_vocal_fold_mesh(shape);
  shape.x_offset = 0.020;
  const SolidMesh there = make_vocal_fold_mesh(shape);
  EXPECT_LE((there.node_position - here.node_position - Eigen::RowVector3d(0.020, 0, 0).replicate(here.n_nodes(), 1))
                .cwiseAbs()
                .maxCoeff(),
            1e-16);
}

TEST(WettedSurface, HasNormalsOutOfTheBodyAndItsMarkers) {
  const SolidMesh mesh = make_vocal_fold_mesh(fold(1.75e-3, {6, 9, 12}));
  const WettedSurface wetted = make_wetted_surface(mesh, {"inferior", "medial", "superior"});
  EXPECT_NO_THROW(surface::check_surface(wetted.surface, "fold"));
  EXPECT_EQ(wetted.surface.n_faces(), (9 + 6 + 9) * 12);
  EXPECT_EQ(wetted.surface.marker.size(), 7u);
  EXPECT_EQ(wetted.surface.region, (std::vector<std::string>{"inferior", "medial", "superior"}));
  // Sum of face areas by corners: inferior points upstream, medial to the glottis, superior downstream.
  Eigen::Vector3d area[3] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (Eigen::Index f = 0; f < wetted.surface.n_faces(); ++f) {
    const auto corner = [&](Eigen::Index c) -> Eigen::Vector3d {
      return wetted.surface.node_position.row(wetted.surface.face_node[8 * f + c]);
    };
    area[wetted.surface.face_region[f]] += (corner(2) - corner(0)).cross(corner(3) - corner(1)) / 2;
  }
  EXPECT_LT(area[0].x(), 0);
  EXPECT_GT(area[1].y(), 0);
  EXPECT_GT(area[2].x(), 0);
}

TEST(WettedSurface, NamesTheSurfacesThatThereAre) {
  const SolidMesh mesh = make_vocal_fold_mesh(fold(1.75e-3, {3, 4, 4}));
  try {
    make_wetted_surface(mesh, {"medial", "dorsal"});
    FAIL();
  } catch (const report::SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("wetted: the mesh has no surface \"dorsal\""), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("superior"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace couplet::solid
