#include "solid-server/mesh/node_order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "solid-server/element/quadrature.hpp"
#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {

namespace {

int n_check_points(ElementShape shape) {
  switch (shape) {
    case ElementShape::hexahedron20:
      return 27;
    case ElementShape::hexahedron8:
      return 8;
    case ElementShape::tetrahedron10:
      return 15;
  }
  return 0;
}

/// Orders of corners in which files are known to give elements; the first is the right one.
std::vector<std::vector<int>> known_corner_orders(ElementShape shape) {
  if (shape == ElementShape::tetrahedron10) return {{0, 1, 2, 3}, {0, 2, 1, 3}};
  return {{0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 6, 7, 0, 1, 2, 3}, {0, 1, 3, 2, 4, 5, 7, 6}, {4, 5, 7, 6, 0, 1, 3, 2}};
}

int n_edges(const ElementTopology& shape) {
  return shape.n_nodes - shape.n_corners;
}

/// The element with its corners in this order, and each edge with the midside node that is nearest to its middle.
Eigen::Matrix3Xd reordered(const ElementTopology& shape, const Eigen::Matrix3Xd& position,
                           const std::vector<int>& corners) {
  Eigen::Matrix3Xd out(3, shape.n_nodes);
  for (Eigen::Index c = 0; c < shape.n_corners; ++c) out.col(c) = position.col(corners[static_cast<std::size_t>(c)]);
  std::vector<bool> is_taken(static_cast<std::size_t>(shape.n_nodes), false);
  for (int e = 0; e < n_edges(shape); ++e) {
    const auto& edge = shape.edge[static_cast<std::size_t>(e)];
    const Eigen::Vector3d middle = (out.col(edge[0]) + out.col(edge[1])) / 2;
    int nearest = -1;
    for (int node = shape.n_corners; node < shape.n_nodes; ++node)
      if (!is_taken[static_cast<std::size_t>(node)] &&
          (nearest < 0 || (position.col(node) - middle).norm() < (position.col(nearest) - middle).norm()))
        nearest = node;
    is_taken[static_cast<std::size_t>(nearest)] = true;
    out.col(shape.n_corners + e) = position.col(nearest);
  }
  return out;
}

}  // namespace

JacobianMeasure::JacobianMeasure(ElementShape shape) {
  const ElementTopology& t = topology(shape);
  std::vector<Eigen::Vector3d> points;
  for (const QuadraturePoint& point : element_quadrature(shape, n_check_points(shape))) points.push_back(point.xi);
  for (std::size_t c = 0; c < static_cast<std::size_t>(t.n_corners); ++c)
    points.push_back(Eigen::Vector3d::Map(t.coordinate[c].data()));
  n_points_ = static_cast<Eigen::Index>(points.size());
  gradient_.resize(3 * n_points_, t.n_nodes);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto gradient = shape_gradient(shape, points[p]);
    for (Eigen::Index k = 0; k < 3; ++k)
      gradient_.row(k * n_points_ + static_cast<Eigen::Index>(p)) = gradient.col(k).transpose();
  }
}

JacobianRange JacobianMeasure::of(const Eigen::Matrix3Xd& position) const {
  Eigen::MatrixX3d jacobian = Eigen::MatrixX3d::Zero(gradient_.rows(), 3);  // dX_J/dxi_k, (k n_points + point, J)
  for (Eigen::Index a = 0; a < gradient_.cols(); ++a)
    for (Eigen::Index J = 0; J < 3; ++J) jacobian.col(J) += position(J, a) * gradient_.col(a);
  const auto d = [&](Eigen::Index k, Eigen::Index J) {
    return jacobian.col(J).segment(k * n_points_, n_points_).array();
  };
  const Eigen::ArrayXd determinant = d(0, 0) * (d(1, 1) * d(2, 2) - d(1, 2) * d(2, 1)) +
                                     d(0, 1) * (d(1, 2) * d(2, 0) - d(1, 0) * d(2, 2)) +
                                     d(0, 2) * (d(1, 0) * d(2, 1) - d(1, 1) * d(2, 0));
  return {determinant.minCoeff(), determinant.maxCoeff()};
}

std::vector<MidsidePlace> midside_places(ElementShape shape, const Eigen::Matrix3Xd& position) {
  const ElementTopology& t = topology(shape);
  std::vector<MidsidePlace> places(static_cast<std::size_t>(n_edges(t)));
  for (std::size_t e = 0; e < places.size(); ++e) {
    const Eigen::Vector3d start = position.col(t.edge[e][0]), edge = position.col(t.edge[e][1]) - start;
    const Eigen::Vector3d midside = position.col(t.n_corners + static_cast<Eigen::Index>(e)) - start;
    places[e] = {midside.dot(edge) / edge.squaredNorm(), (midside - edge / 2).norm() / edge.norm()};
  }
  return places;
}

bool would_be_good_in_another_order(ElementShape shape, const Eigen::Matrix3Xd& position,
                                    const JacobianMeasure& measure) {
  for (const std::vector<int>& corners : known_corner_orders(shape)) {
    const Eigen::Matrix3Xd other = reordered(topology(shape), position, corners);
    if (!(measure.of(other).smallest > 0)) continue;
    const auto places = midside_places(shape, other);
    if (std::all_of(places.begin(), places.end(), [](const MidsidePlace& place) { return place.is_good(); }))
      return true;
  }
  return false;
}

}  // namespace couplet::solid
