#include "solid-server/element/shape_functions.hpp"

#include "solid-server/element/hex20.hpp"

namespace couplet::solid {

namespace {

/// Products of 1 + x x_a over the axes, 2^-d of them: 4-node quadrilateral and 8-node hexahedron.
template <int d, class Corner>
double multilinear(const Eigen::Matrix<double, d, 1>& x, const Corner& corner, Eigen::Matrix<double, d, 1>& slope) {
  double value = 1.0 / (1 << d);
  for (Eigen::Index k = 0; k < d; ++k) value *= 1 + x[k] * corner(k);
  for (Eigen::Index k = 0; k < d; ++k) {
    slope[k] = corner(k) / (1 << d);
    for (Eigen::Index l = 0; l < d; ++l)
      if (l != k) slope[k] *= 1 + x[l] * corner(l);
  }
  return value;
}

/// Quadratic simplex by its barycentric coordinates L and their constant slopes: corners L (2 L - 1), edges 4 L_i L_j.
template <int d, class Values, class Gradient>
void quadratic_simplex(const Eigen::Matrix<double, d, 1>& xi, const std::array<std::array<int, 2>, 6>& edge,
                       Values& values, Gradient& gradient) {
  Eigen::Matrix<double, d + 1, 1> L;
  Eigen::Matrix<double, d + 1, d> slope = Eigen::Matrix<double, d + 1, d>::Zero();
  L[0] = 1 - xi.sum();
  L.template tail<d>() = xi;
  slope.row(0).setConstant(-1);
  slope.template bottomRows<d>().setIdentity();
  for (Eigen::Index c = 0; c <= d; ++c) {
    values[c] = L[c] * (2 * L[c] - 1);
    gradient.row(c) = (4 * L[c] - 1) * slope.row(c);
  }
  for (Eigen::Index e = 0; e < d * (d + 1) / 2; ++e) {
    const auto [i, j] = edge[static_cast<std::size_t>(e)];
    values[d + 1 + e] = 4 * L[i] * L[j];
    gradient.row(d + 1 + e) = 4 * (L[i] * slope.row(j) + L[j] * slope.row(i));
  }
}

constexpr std::array<std::array<int, 2>, 6> triangle_edge = {{{0, 1}, {1, 2}, {2, 0}, {}, {}, {}}};
constexpr std::array<std::array<int, 2>, 6> tetrahedron_edge = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

struct ElementAt {
  ShapeValues<max_element_nodes> values;
  ShapeGradient<max_element_nodes, 3> gradient;
};

ElementAt at(ElementShape shape, const Eigen::Vector3d& xi) {
  const ElementTopology& t = topology(shape);
  ElementAt out{ShapeValues<max_element_nodes>(t.n_nodes), ShapeGradient<max_element_nodes, 3>(t.n_nodes, 3)};
  switch (shape) {
    case ElementShape::hexahedron20:
      out.values = hex20::shape(xi);
      out.gradient = hex20::shape_gradient(xi);
      break;
    case ElementShape::hexahedron8:
      for (std::size_t a = 0; a < 8; ++a) {
        const auto corner = [&](Eigen::Index k) { return t.coordinate[a][static_cast<std::size_t>(k)]; };
        Eigen::Vector3d slope;
        out.values[static_cast<Eigen::Index>(a)] = multilinear<3>(xi, corner, slope);
        out.gradient.row(static_cast<Eigen::Index>(a)) = slope;
      }
      break;
    case ElementShape::tetrahedron10:
      quadratic_simplex<3>(xi, tetrahedron_edge, out.values, out.gradient);
      break;
  }
  return out;
}

struct FaceAt {
  ShapeValues<max_face_nodes> values;
  ShapeGradient<max_face_nodes, 2> gradient;
};

FaceAt at(FaceShape shape, const Eigen::Vector2d& xi) {
  const int n = n_nodes_of(shape);
  FaceAt out{ShapeValues<max_face_nodes>(n), ShapeGradient<max_face_nodes, 2>(n, 2)};
  switch (shape) {
    case FaceShape::quadrilateral8:
      out.values = hex20::face_shape(xi);
      out.gradient = hex20::face_shape_gradient(xi);
      break;
    case FaceShape::quadrilateral4:
      for (Eigen::Index a = 0; a < 4; ++a) {
        const auto corner = [&](Eigen::Index k) { return (k == 0 ? a == 1 || a == 2 : a >= 2) ? 1.0 : -1.0; };
        Eigen::Vector2d slope;
        out.values[a] = multilinear<2>(xi, corner, slope);
        out.gradient.row(a) = slope;
      }
      break;
    case FaceShape::triangle6:
      quadratic_simplex<2>(xi, triangle_edge, out.values, out.gradient);
      break;
  }
  return out;
}

}  // namespace

ShapeValues<max_element_nodes> shape_values(ElementShape shape, const Eigen::Vector3d& xi) {
  return at(shape, xi).values;
}

ShapeGradient<max_element_nodes, 3> shape_gradient(ElementShape shape, const Eigen::Vector3d& xi) {
  return at(shape, xi).gradient;
}

ShapeValues<max_face_nodes> shape_values(FaceShape shape, const Eigen::Vector2d& xi) {
  return at(shape, xi).values;
}

ShapeGradient<max_face_nodes, 2> shape_gradient(FaceShape shape, const Eigen::Vector2d& xi) {
  return at(shape, xi).gradient;
}

}  // namespace couplet::solid
