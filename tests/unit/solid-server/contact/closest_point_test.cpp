#include "solid-server/contact/closest_point.hpp"

#include <gtest/gtest.h>

#include <random>

#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {
namespace {

constexpr std::array<FaceShape, 3> all_shapes = {FaceShape::quadrilateral8, FaceShape::quadrilateral4,
                                                 FaceShape::triangle6};

using Nodes = std::array<NodeQuad, max_face_nodes>;

/// A face of size 2 in a skewed plane, every node moved by up to 0.15 in each direction: strongly curved.
Nodes random_face(FaceShape shape, std::mt19937& random) {
  std::uniform_real_distribution<double> move(-0.15, 0.15);
  Nodes nodes{};
  const int n_corners = n_corners_of(shape);
  for (int a = 0; a < n_nodes_of(shape); ++a) {
    const FaceCoordinates at = a < n_corners ? on_edge(shape, a, -1) : on_edge(shape, a - n_corners, 0);
    nodes[static_cast<std::size_t>(a)] =
        NodeQuad{at.x() + 0.3 * at.y() + move(random), at.y() + move(random), 0.2 * at.x() + move(random), 0};
  }
  return nodes;
}

NodeQuad interpolate(FaceShape shape, const Nodes& nodes, const FaceCoordinates& at) {
  const auto N = shape_values(shape, at);
  NodeQuad sum{};
  for (int a = 0; a < N.size(); ++a) sum += N[a] * nodes[static_cast<std::size_t>(a)];
  return sum;
}

FaceCoordinates in_face(FaceShape shape, double p, double q) {  // p, q from 0 to 1
  if (shape == FaceShape::triangle6) return {p * (1 - q), q};
  return {2 * p - 1, 2 * q - 1};
}

TEST(CurvedFace, IsWhatTheShapeFunctionsSay) {
  std::mt19937 random(1);
  for (const FaceShape shape : all_shapes) {
    const Nodes nodes = random_face(shape, random);
    const CurvedFace face(shape, nodes);
    const auto box = face.box();
    for (double p = 0; p <= 1; p += 0.125)
      for (double q = 0; q <= 1; q += 0.125) {
        const FaceCoordinates at = in_face(shape, p, q);
        const FacePoint point = face.at(at);
        EXPECT_LT(length(point.position - interpolate(shape, nodes, at)), 1e-14);
        const double h = 1e-4;
        const auto r = [&](double s) { return face.at({at.x() + s, at.y()}); };
        const auto t = [&](double s) { return face.at({at.x(), at.y() + s}); };
        // Central differences of polynomials of degree two in each direction: exact but for round-off / h.
        EXPECT_LT(length(point.tangent_xi - (r(h).position - r(-h).position) / (2 * h)), 1e-11);
        EXPECT_LT(length(point.tangent_eta - (t(h).position - t(-h).position) / (2 * h)), 1e-11);
        EXPECT_LT(length(point.second_xi - (r(h).tangent_xi - r(-h).tangent_xi) / (2 * h)), 1e-11);
        EXPECT_LT(length(point.second_mixed - (t(h).tangent_xi - t(-h).tangent_xi) / (2 * h)), 1e-11);
        EXPECT_LT(length(point.second_eta - (t(h).tangent_eta - t(-h).tangent_eta) / (2 * h)), 1e-11);
        for (int i = 0; i < 3; ++i) {
          EXPECT_GE(point.position[i], box.low[i] - 1e-15);
          EXPECT_LE(point.position[i], box.high[i] + 1e-15);
        }
      }
  }
}

TEST(ClosestPoint, IsNoFurtherThanAnyPointOfTheFace) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> coordinate(-1.6, 1.6), height(-0.5, 0.5);
  int n_inside = 0, n_edge = 0, n_corner = 0;
  for (const FaceShape shape : all_shapes)
    for (int n = 0; n < 300; ++n) {
      const Nodes nodes = random_face(shape, random);
      const CurvedFace face(shape, nodes);
      const NodeQuad x{coordinate(random), coordinate(random), height(random), 0};
      const ClosestPoint found = closest_point(face, x);

      // It is a point of the face, at the distance that is said,
      EXPECT_LT(length(found.position - interpolate(shape, nodes, found.at)), 1e-14);
      EXPECT_NEAR(found.distance, length(x - found.position), 1e-15);
      const bool is_triangle = shape == FaceShape::triangle6;
      EXPECT_GE(std::min(found.at.x(), found.at.y()), (is_triangle ? 0 : -1) - 1e-15);
      EXPECT_LE(is_triangle ? found.at.sum() : found.at.maxCoeff(), 1 + 1e-15);
      // and none of 100 x 100 others is closer.
      double closest = found.distance;
      for (int p = 0; p <= 100; ++p)
        for (int q = 0; q <= 100; ++q)
          closest = std::min(closest, length(x - face.at(in_face(shape, p / 100., q / 100.)).position));
      EXPECT_GE(closest, found.distance - 1e-14) << "face " << n;

      n_corner += found.corner >= 0;
      n_edge += found.edge >= 0 && found.corner < 0;
      n_inside += found.edge < 0;
      if (found.edge >= 0) continue;
      // Inside, the distance is along the normal: Newton has converged.
      const NodeQuad r = x - found.position;
      EXPECT_LT(length(cross(r, face.normal(found.at))), 1e-13);
    }
  for (const int count : {n_inside, n_edge, n_corner}) EXPECT_GT(count, 100);  // all three kinds were tested
}

}  // namespace
}  // namespace couplet::solid
