#include "solid-server/element/hex20.hpp"

namespace couplet::solid::hex20 {

namespace {

/// One factor of a shape function and its derivative: 1 + x x_a towards a corner, 1 - x^2 along an edge.
struct Factor {
  double value, slope;
};

Factor factor(double x, int x_a) {
  return x_a == 0 ? Factor{1 - x * x, -2 * x} : Factor{1 + x * x_a, static_cast<double>(x_a)};
}

/// Serendipity function of a corner or midside node in 2 or 3 dimensions, and its gradient:
/// corners 2^-d prod(1 + x x_a) (sum x x_a - (d - 1)), midside nodes 2^-(d-1) prod.
template <int d>
double serendipity(const Eigen::Matrix<double, d, 1>& x, const std::array<int, d>& x_a,
                   Eigen::Matrix<double, d, 1>& slope) {
  std::array<Factor, d> factors;
  bool is_corner = true;
  double product = 1, sum = -(d - 1);
  for (std::size_t k = 0; k < d; ++k) {
    factors[k] = factor(x[static_cast<Eigen::Index>(k)], x_a[k]);
    is_corner &= x_a[k] != 0;
    product *= factors[k].value;
    sum += x[static_cast<Eigen::Index>(k)] * x_a[k];
  }
  const double scale = 1.0 / (1 << (is_corner ? d : d - 1));
  for (std::size_t k = 0; k < d; ++k) {
    double others = 1;
    for (std::size_t l = 0; l < d; ++l)
      if (l != k) others *= factors[l].value;
    double change = factors[k].slope * others;
    if (is_corner) change = change * sum + product * x_a[k];
    slope[static_cast<Eigen::Index>(k)] = scale * change;
  }
  return scale * (is_corner ? product * sum : product);
}

constexpr std::array<std::array<int, 2>, n_face_nodes> face_coordinate = {
    {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}}};

}  // namespace

Eigen::Matrix<double, n_nodes, 1> shape(const Eigen::Vector3d& xi) {
  Eigen::Matrix<double, n_nodes, 1> values;
  Eigen::Vector3d slope;
  for (int a = 0; a < n_nodes; ++a) values[a] = serendipity<3>(xi, node_coordinate[static_cast<std::size_t>(a)], slope);
  return values;
}

Eigen::Matrix<double, n_nodes, 3> shape_gradient(const Eigen::Vector3d& xi) {
  Eigen::Matrix<double, n_nodes, 3> gradient;
  Eigen::Vector3d slope;
  for (int a = 0; a < n_nodes; ++a) {
    serendipity<3>(xi, node_coordinate[static_cast<std::size_t>(a)], slope);
    gradient.row(a) = slope;
  }
  return gradient;
}

Eigen::Matrix<double, n_face_nodes, 1> face_shape(const Eigen::Vector2d& xi) {
  Eigen::Matrix<double, n_face_nodes, 1> values;
  Eigen::Vector2d slope;
  for (int a = 0; a < n_face_nodes; ++a)
    values[a] = serendipity<2>(xi, face_coordinate[static_cast<std::size_t>(a)], slope);
  return values;
}

Eigen::Matrix<double, n_face_nodes, 2> face_shape_gradient(const Eigen::Vector2d& xi) {
  Eigen::Matrix<double, n_face_nodes, 2> gradient;
  Eigen::Vector2d slope;
  for (int a = 0; a < n_face_nodes; ++a) {
    serendipity<2>(xi, face_coordinate[static_cast<std::size_t>(a)], slope);
    gradient.row(a) = slope;
  }
  return gradient;
}

}  // namespace couplet::solid::hex20
