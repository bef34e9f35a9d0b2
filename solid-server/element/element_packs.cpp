#include "solid-server/element/element_packs.hpp"

#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/element/deformation.hpp"

namespace couplet::solid {

namespace {

[[noreturn]] void refuse_folded(const SolidMesh& mesh, Index element) {
  throw report::SceneError("solid.body", mesh.describe_element(element) + " is folded at rest",
                           "change the element counts or the shape of the mesh");
}

/// The elements of each pack, counted in the block, -1 where there is none.
std::vector<Index> fill_lanes(const ElementBlock& block) {
  const Index per_layer = block.n_elements_per_layer > 0 ? block.n_elements_per_layer : block.n_elements();
  std::vector<Index> lanes;
  for (Index element = 0; element < block.n_elements(); ++element) {
    if (element % per_layer == 0) lanes.resize((lanes.size() + n_lanes - 1) / n_lanes * n_lanes, -1);
    lanes.push_back(element);
  }
  lanes.resize((lanes.size() + n_lanes - 1) / n_lanes * n_lanes, -1);
  return lanes;
}

void store_geometry(const ReferencePoint& point, std::size_t lane, StoredPack* geometry) {
  for (int k = 0; k < 3; ++k)
    for (int J = 0; J < 3; ++J) geometry[3 * k + J].lane[lane] = point.inverse_jacobian(k, J);
  geometry[9].lane[lane] = point.volume;
}

/// Geometry of the eight elements of a pack, (n_points, 10).
std::vector<StoredPack> geometry_of(const SolidMesh& mesh, const ElementBlock& block,
                                    const std::array<Index, n_lanes>& elements,
                                    const std::vector<QuadraturePoint>& points) {
  std::vector<StoredPack> geometry(points.size() * 10);
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    const ElementVectors position = at_element(mesh.node_position, block.nodes_of(elements[lane]));
    for (std::size_t q = 0; q < points.size(); ++q) {
      const ReferencePoint reference = reference_point(block.shape, position, points[q]);
      if (!(reference.volume > 0)) refuse_folded(mesh, block.first_element + elements[lane]);
      store_geometry(reference, lane, &geometry[10 * q]);
    }
  }
  return geometry;
}

void store_axes(const ElementBlock& block, const std::array<Index, n_lanes>& elements, std::vector<StoredPack>& axes) {
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (Eigen::Index J = 0; J < 3; ++J) {
      StoredPack& component = axes.emplace_back();
      for (std::size_t lane = 0; lane < n_lanes; ++lane)
        component.lane[lane] = block.axes[static_cast<std::size_t>(elements[lane])][axis][J];
    }
}

/// Whether two geometries differ by no more than the round-off of node positions.
bool are_alike(const std::vector<StoredPack>& a, const StoredPack* b) {
  constexpr double round_off = 1e-12;
  for (std::size_t q = 0; q < a.size(); q += 10)
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      double size = 0, difference = 0;
      for (std::size_t n = q; n < q + 9; ++n) {
        size = std::max(size, std::abs(a[n].lane[lane]));
        difference = std::max(difference, std::abs(a[n].lane[lane] - b[n].lane[lane]));
      }
      if (difference > round_off * size) return false;
      if (std::abs(a[q + 9].lane[lane] - b[q + 9].lane[lane]) > round_off * a[q + 9].lane[lane]) return false;
    }
  return true;
}

}  // namespace

ElementPacks make_element_packs(const SolidMesh& mesh, const ElementBlock& block, int n_points,
                                ElementFormulation formulation) {
  const auto points = element_quadrature(block.shape, n_points);
  ElementPacks packs;
  packs.shape = block.shape;
  packs.formulation = formulation;
  packs.n_nodes = topology(block.shape).n_nodes;
  packs.n_points = n_points;
  packs.n_elements = block.n_elements();
  for (const QuadraturePoint& point : points) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> gradient = shape_gradient(block.shape, point.xi);
    packs.natural_gradient.insert(packs.natural_gradient.end(), gradient.data(), gradient.data() + gradient.size());
  }
  packs.lane_element = fill_lanes(block);
  packs.n_packs = static_cast<Index>(packs.lane_element.size()) / n_lanes;
  const Index per_layer = (block.n_elements_per_layer + n_lanes - 1) / n_lanes;  // packs; 0: no layers

  for (Index p = 0; p < packs.n_packs; ++p) {
    std::array<Index, n_lanes> elements{};
    Index last = 0;  // the lanes of a pack fill from the first on
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      Index& element = packs.lane_element[static_cast<std::size_t>(p * n_lanes) + lane];
      if (element >= 0) last = element;
      elements[lane] = last;
      if (element >= 0) element += block.first_element;
    }
    for (std::size_t a = 0; a < static_cast<std::size_t>(packs.n_nodes); ++a)
      for (const Index element : elements)
        packs.node_start.push_back(NodeVectors::ColsAtCompileTime * block.nodes_of(element)[a]);
    if (!block.axes.empty()) store_axes(block, elements, packs.axes);

    const auto geometry = geometry_of(mesh, block, elements, points);
    if (per_layer > 0 && p >= per_layer) {
      const Index below = packs.geometry_start[static_cast<std::size_t>(p - per_layer)];
      if (are_alike(geometry, &packs.geometry[static_cast<std::size_t>(below)])) {
        packs.geometry_start.push_back(below);
        continue;
      }
    }
    packs.geometry_start.push_back(static_cast<Index>(packs.geometry.size()));
    packs.geometry.insert(packs.geometry.end(), geometry.begin(), geometry.end());
  }
  return packs;
}

}  // namespace couplet::solid
