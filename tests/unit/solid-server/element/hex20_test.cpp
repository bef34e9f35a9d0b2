#include "solid-server/element/hex20.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/element/quadrature.hpp"

namespace couplet::solid {
namespace {

const Eigen::Vector3d somewhere(0.3, -0.7, 0.45);

TEST(Hex20, ShapeFunctionsAreOneAtTheirNodeAndZeroAtTheOthers) {
  for (int a = 0; a < hex20::n_nodes; ++a) {
    const auto& c = hex20::node_coordinate[static_cast<std::size_t>(a)];
    const auto N = hex20::shape(Eigen::Vector3d(c[0], c[1], c[2]));
    for (int b = 0; b < hex20::n_nodes; ++b) EXPECT_DOUBLE_EQ(N[b], a == b ? 1 : 0);
  }
}

TEST(Hex20, ShapeFunctionsRepresentQuadraticsExactly) {
  const auto quadratic = [](const Eigen::Vector3d& x) {
    return 1 + 2 * x[0] - x[1] + 3 * x[2] + x[0] * x[1] - 2 * x[1] * x[2] + x[0] * x[0] - x[2] * x[2] + x[1] * x[1];
  };
  double interpolated = 0;
  const auto N = hex20::shape(somewhere);
  for (int a = 0; a < hex20::n_nodes; ++a) {
    const auto& c = hex20::node_coordinate[static_cast<std::size_t>(a)];
    interpolated += N[a] * quadratic(Eigen::Vector3d(c[0], c[1], c[2]));
  }
  EXPECT_NEAR(interpolated, quadratic(somewhere), 1e-14);
}

TEST(Hex20, GradientsAreTheDerivativesOfTheShapeFunctions) {
  const double h = 1e-6;
  const auto gradient = hex20::shape_gradient(somewhere);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
    const auto difference = ((hex20::shape(somewhere + step) - hex20::shape(somewhere - step)) / (2 * h)).eval();
    EXPECT_LE((gradient.col(k) - difference).cwiseAbs().maxCoeff(), 1e-9);  // h^2 and 1e-16 / h
  }
}

TEST(Hex20, FaceShapeFunctionsAreThoseOfTheElementOnItsFace) {
  // Face zeta = +1: (xi, eta) of the face are (xi, eta) of the element.
  const Eigen::Vector2d on_face(0.2, -0.6);
  const auto face = hex20::face_shape(on_face);
  const auto element = hex20::shape(Eigen::Vector3d(0.2, -0.6, 1));
  for (int a = 0; a < hex20::n_face_nodes; ++a)
    EXPECT_NEAR(face[a], element[hex20::face_node[hex20::zeta_max][static_cast<std::size_t>(a)]], 1e-15);
}

TEST(Quadrature, IntegratesWhatItPromises) {
  struct Promise {
    int n_points, degree;  // of a monomial in one direction
  };
  for (const auto& [n_points, degree] : {Promise{8, 3}, Promise{14, 5}, Promise{27, 5}})
    for (int power = 0; power <= degree; ++power) {
      double integral = 0;
      for (const auto& point : element_quadrature(ElementShape::hexahedron20, n_points))
        integral += point.weight * std::pow(point.xi[1], power);
      EXPECT_NEAR(integral, power % 2 == 0 ? 8.0 / (power + 1) : 0, 1e-14) << n_points << " points, power " << power;
    }
}

TEST(Quadrature, RefusesACountThatThereIsNot) {
  EXPECT_THROW(element_quadrature(ElementShape::hexahedron20, 9), report::SceneError);
}

}  // namespace
}  // namespace couplet::solid
