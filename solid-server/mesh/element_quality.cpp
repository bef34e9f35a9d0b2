#include "solid-server/mesh/element_quality.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "solid-server/element/shape_functions.hpp"

namespace couplet::solid {

double scaled_jacobian(const SolidMesh& mesh, Index element) {
  const ElementShape shape = mesh.block_of(element).shape;
  const ElementTopology& t = topology(shape);
  const double regular = shape == ElementShape::tetrahedron10 ? std::sqrt(2.0) : 1.0;
  const auto nodes = mesh.nodes_of(element);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t corner = 0; corner < static_cast<std::size_t>(t.n_corners); ++corner) {
    const auto gradient = shape_gradient(shape, Eigen::Vector3d::Map(t.coordinate[corner].data()));
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();  // dX_J/dxi_k, (J, k)
    for (std::size_t a = 0; a < nodes.size(); ++a)
      jacobian += mesh.node_position.row(nodes[a]).transpose() * gradient.row(static_cast<Eigen::Index>(a));
    smallest = std::min(smallest, regular * jacobian.determinant() / jacobian.colwise().norm().prod());
  }
  return smallest;
}

double smallest_scaled_jacobian(const SolidMesh& mesh) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Index element = 0; element < mesh.n_elements(); ++element)
    smallest = std::min(smallest, scaled_jacobian(mesh, element));
  return smallest;
}

}  // namespace couplet::solid
