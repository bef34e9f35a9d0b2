#include "solid-server/mesh/parametric/valve_mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/element/deformation.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/mesh/element_quality.hpp"
#include "solid-server/mesh/parametric/leaflet_grid.hpp"
#include "solid-server/mesh/wetted_surface.hpp"
#include "tests/unit/solid-server/mesh/mesh_measures.hpp"

namespace couplet::solid {
namespace {

TEST(LeafletSurface, IsThePublishedFormulaWithoutClearance) {
  // Values of the formula of the reference (u, v) -> (x, y, z) in mm, computed independently with R = 10.5, H = 14.7,
  // eps = 0.5, sag = 1.5, bulge = 1.8, 35 degrees, to six decimals.
  const LeafletSurface surface({}, 0);
  struct {
    double u, v, x, y, z;
  } const points[] = {{0, 0, 10.5, 0, 0},
                      {0, 1, 0.5, 0, 13.2},
                      {0, 0.5, 6.974474, 0, 5.567562},
                      {0.5, 0.25, 8.107112, 5.074158, 5.71444},
                      {-0.8, 0.7, 5.215769, -7.433136, 12.622005},
                      {1, 0.3, 5.25, 9.093267, 14.7}};
  for (const auto& p : points)
    EXPECT_LE((surface.position(p.u, p.v) * 1e3 - Eigen::Vector3d(p.x, p.y, p.z)).norm(), 2e-6)
        << p.u << ", " << p.v << ": " << surface.position(p.u, p.v).transpose() * 1e3;
}

TEST(LeafletSurface, FindsTheParametersOfItsPoints) {
  const LeafletSurface surface({}, 0.2e-3);
  for (const double u : {-0.99, -0.6, 0.0, 0.3, 0.95})
    for (const double v : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      const Eigen::Vector3d point = surface.position(u, v);
      const Eigen::Vector2d found = surface.parameters_at(point.y(), point.z());
      // Lines of constant u are short near the commissures, so that v is less sharp there than positions are.
      EXPECT_LE((surface.position(found[0], found[1]) - point).norm(), 1e-15) << u << ", " << v;
    }
}

TEST(LeafletSurface, HasANormalPerpendicularToBothTangents) {
  const LeafletSurface surface({}, 0.2e-3);
  constexpr double h = 1e-6;
  for (const double u : {-0.9, -0.4, 0.2, 0.7})
    for (const double v : {0.1, 0.5, 0.9}) {
      const Eigen::Vector3d along = surface.position(u + h, v) - surface.position(u - h, v);
      const Eigen::Vector3d across = surface.position(u, v + h) - surface.position(u, v - h);
      EXPECT_LE(std::abs(surface.normal(u, v).dot(along.normalized())), 1e-8);  // h^2 and rounding over h
      EXPECT_LE(std::abs(surface.normal(u, v).dot(across.normalized())), 1e-8);
      EXPECT_GT(surface.normal(u, v).x(), 0);
      EXPECT_GT(surface.circumferential(u, v).dot(along.normalized()), 1 - 1e-10);
    }
}

class ValveMesh : public testing::TestWithParam<std::tuple<double, std::array<int, 3>>> {
 protected:
  static ValveShape shape() {
    ValveShape s;
    s.thickness = std::get<0>(GetParam());
    s.n_elements = std::get<1>(GetParam());
    return s;
  }
};

TEST_P(ValveMesh, HasWellShapedElements) {
  const SolidMesh mesh = make_valve_mesh(shape());
  EXPECT_NO_THROW(check_mesh(mesh, "valve"));
  EXPECT_EQ(find_parts(mesh).first_element.size(), 3u);
  // The base stands on the tube, to which the leaflet is inclined by 24 degrees at its lowest point: sin(24 deg) =
  // 0.41, somewhat less where a thick leaflet is curved.
  EXPECT_GT(smallest_scaled_jacobian(mesh), 0.28);
}

TEST_P(ValveMesh, KeepsWithinTheTubeAndApart) {
  const ValveShape valve = shape();
  const SolidMesh mesh = make_valve_mesh(valve);
  for (Index element = 0; element < mesh.n_elements(); ++element) {
    const int leaflet = mesh.block_of(element).region.back() - '1';
    const double angle = 2 * std::numbers::pi / 3 * leaflet;
    const Eigen::Vector2d middle(std::cos(angle), std::sin(angle)), side(-std::sin(angle), std::cos(angle));
    for (const Index node : mesh.nodes_of(element)) {
      const Eigen::Vector2d place = mesh.node_position.row(node).tail<2>().transpose();
      ASSERT_LE(place.norm(), valve.leaflet.tube_radius * (1 + 1e-12));
      // Half the gap is kept to the planes at 60 degrees on both sides.
      const double to_plane = std::sin(std::numbers::pi / 3) * place.dot(middle) - 0.5 * std::abs(place.dot(side));
      ASSERT_GE(to_plane, valve.commissure_gap / 2 * (1 - 1e-9));
    }
  }
  for (const Index node : nodes_of_faces(mesh, mesh.surface.at("base")))
    ASSERT_NEAR(mesh.node_position.row(node).tail<2>().norm(), valve.leaflet.tube_radius, 1e-14);
}

TEST_P(ValveMesh, HasTheVolumeOfAreaTimesThickness) {
  const ValveShape valve = shape();
  const SolidMesh mesh = make_valve_mesh(valve);
  const double area = area_of(mesh, "ventricular") / 2 + area_of(mesh, "aortic") / 2;
  // The volume between two parallel surfaces is that of the mean area to second order in thickness over radius of
  // curvature; the sheared rim makes no difference to first order.
  EXPECT_NEAR(volume_of(mesh) / (area * valve.thickness), 1, 0.01);
  EXPECT_NEAR(area / 3 * 1e4, 2.20, 0.25);  // [cm^2] 2.20 without clearance, which takes from it with the thickness
}

INSTANTIATE_TEST_SUITE_P(Shapes, ValveMesh,
                         testing::Combine(testing::Values(0.05e-3, 0.3e-3, 0.8e-3),
                                          testing::Values(std::array{6, 4, 1}, std::array{15, 11, 2},
                                                          std::array{20, 16, 1})));

TEST(ValveMeshNames, CoverTheWholeBoundaryOnce) {
  const SolidMesh mesh = make_valve_mesh({});
  EXPECT_EQ(n_boundary_faces(mesh), mesh.surface.at("ventricular").size() + mesh.surface.at("aortic").size() +
                                        mesh.surface.at("free_edge").size() + mesh.surface.at("base").size());
  for (const char* name : {"ventricular", "aortic", "free_edge", "base", "contact"}) {
    std::size_t n_faces = 0;
    for (const char* leaflet : {"_1", "_2", "_3"}) n_faces += mesh.surface.at(name + std::string(leaflet)).size();
    EXPECT_EQ(n_faces, mesh.surface.at(name).size()) << name;
    EXPECT_GT(n_faces, 0u) << name;
  }
  ASSERT_EQ(mesh.block.size(), 3u);
  EXPECT_EQ(mesh.block[2].region, "leaflet_3");
  EXPECT_EQ(mesh.n_elements(), 3 * 288);  // 4 elements in the ring: 12 x 12 + 4 (12 + 2 x 12)
  EXPECT_EQ(mesh.find_nodes("commissure_2", "").size(), 2u * 3u);
}

TEST(ValveMeshNames, PointWherePressureActs) {
  const SolidMesh mesh = make_valve_mesh({});
  // Pressure on the ventricular side of leaflet 1, whose middle stands towards y, pushes it outwards and downstream, on
  // the aortic side back; both sides have the same area to first order.
  const Eigen::Vector3d opening = -area_vector_of(mesh, "ventricular_1"), closing = -area_vector_of(mesh, "aortic_1");
  EXPECT_GT(opening.y(), 0);
  EXPECT_GT(opening.x(), 0);
  EXPECT_LT(closing.y(), 0);
  EXPECT_LT(closing.x(), 0);
  EXPECT_LT(std::abs(opening.z()), 1e-9 * opening.norm());  // symmetric to the plane through its middle
}

TEST(ValveMeshNames, HaveMarkersInTheMiddleOfEachLeaflet) {
  const SolidMesh mesh = make_valve_mesh({});
  for (const int k : {0, 1, 2}) {
    const double angle = 2 * std::numbers::pi / 3 * k;
    const std::string suffix = "_" + std::to_string(k + 1);
    double last_x = -1;
    for (const char* name : {"lower_belly", "upper_belly", "free_edge_middle"}) {
      const Eigen::Vector3d place = mesh.node_position.row(mesh.marker.at(name + suffix));
      EXPECT_NEAR(-std::sin(angle) * place.y() + std::cos(angle) * place.z(), 0, 1e-9) << name;
      EXPECT_GT(std::cos(angle) * place.y() + std::sin(angle) * place.z(), 0) << name;
      EXPECT_GT(place.x(), last_x) << name;
      last_x = place.x();
    }
    EXPECT_NEAR(last_x, 13.2e-3, 0.2e-3);  // H - sag, and half a thickness along the inclined normal
  }
}

TEST(ValveMeshAxes, RunAlongTheLeaflet) {
  const SolidMesh mesh = make_valve_mesh({});
  for (const ElementBlock& block : mesh.block) {
    ASSERT_EQ(block.axes.size(), static_cast<std::size_t>(block.n_elements()));
    for (const MaterialAxes& axes : block.axes) {
      EXPECT_NEAR(axes[0].norm(), 1, 1e-12);
      EXPECT_NEAR(axes[1].norm(), 1, 1e-12);
      EXPECT_NEAR(axes[0].dot(axes[1]), 0, 1e-12);
      EXPECT_GT(axes[1].x(), 0);  // towards the free edge, downstream
    }
  }
}

TEST(ValveMeshRefusal, NamesTheValueAndALimit) {
  const auto refusal = [](const ValveShape& shape) -> std::string {
    try {
      make_valve_mesh(shape);
    } catch (const report::SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  ValveShape shape;
  shape.thickness = 0;
  EXPECT_EQ(refusal(shape), "valve: a thickness of 0 m is not above 0");
  shape.thickness = 4e-3;
  EXPECT_EQ(refusal(shape),
            "valve: thickness and commissure_gap of 4.1 mm together are not below 0.2 times the tube_radius; choose a "
            "thinner "
            "leaflet");
  shape.thickness = 0.3e-3;
  shape.n_elements = {3, 4, 1};
  EXPECT_EQ(refusal(shape),
            "valve: 3 by 4 elements are too few for a leaflet; give at least 4 along the free edge and 2 across");
  shape.n_elements = {8, 4, 1};
  shape.leaflet.bulge = 4e-3;
  EXPECT_EQ(refusal(shape),
            "valve: a bulge of 4 mm is not between 0 and 0.25 times the tube_radius; choose 0.17 times the radius");
}

}  // namespace
}  // namespace couplet::solid
