#include "solid-server/element/element_packs.hpp"

#include <algorithm>

#include "proto/report/failure.hpp"
#include "solid-server/element/deformation.hpp"
#include "solid-server/element/hex20.hpp"

namespace couplet::solid {

namespace {

[[noreturn]] void refuse_folded(const SolidMesh& mesh, Index element) {
  const ElementVectors position = at_element(mesh.node_position, mesh.element_node[static_cast<std::size_t>(element)]);
  const Eigen::Vector3d middle = position.colwise().mean();
  throw report::SceneError("solid.body[0]",
                           "element " + std::to_string(element) + " at (" + std::to_string(middle.x()) + ", " +
                               std::to_string(middle.y()) + ", " + std::to_string(middle.z()) + ") m is folded at rest",
                           "change the element counts or the shape of the mesh");
}

void store_geometry(const ReferencePoint& point, std::size_t lane, StoredPack* geometry) {
  for (int k = 0; k < 3; ++k)
    for (int J = 0; J < 3; ++J) geometry[3 * k + J].lane[lane] = point.inverse_jacobian(k, J);
  geometry[9].lane[lane] = point.volume;
}

}  // namespace

ElementPacks make_element_packs(const SolidMesh& mesh, int n_points) {
  const auto points = element_quadrature(n_points);
  ElementPacks packs;
  packs.n_points = n_points;
  packs.n_elements = mesh.n_elements();
  packs.n_packs = (packs.n_elements + n_lanes - 1) / n_lanes;
  for (const QuadraturePoint& point : points) {
    const Eigen::Matrix<double, hex20::n_nodes, 3, Eigen::RowMajor> gradient = hex20::shape_gradient(point.xi);
    packs.natural_gradient.insert(packs.natural_gradient.end(), gradient.data(), gradient.data() + gradient.size());
  }

  const auto n_packs = static_cast<std::size_t>(packs.n_packs);
  packs.node_start.resize(n_packs * hex20::n_nodes * n_lanes);
  packs.geometry.resize(n_packs * points.size() * 10);
  for (std::size_t p = 0; p < n_packs; ++p)
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const auto element = std::min(static_cast<Index>(p * n_lanes + lane), packs.n_elements - 1);
      const auto& nodes = mesh.element_node[static_cast<std::size_t>(element)];
      for (std::size_t a = 0; a < nodes.size(); ++a)
        packs.node_start[(p * hex20::n_nodes + a) * n_lanes + lane] = NodeVectors::ColsAtCompileTime * nodes[a];
      const ElementVectors position = at_element(mesh.node_position, nodes);
      for (std::size_t q = 0; q < points.size(); ++q) {
        const ReferencePoint reference = reference_point(position, points[q]);
        if (!(reference.volume > 0)) refuse_folded(mesh, element);
        store_geometry(reference, lane, &packs.geometry[(p * points.size() + q) * 10]);
      }
    }
  return packs;
}

}  // namespace couplet::solid
