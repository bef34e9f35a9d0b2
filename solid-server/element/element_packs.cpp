#include "solid-server/element/element_packs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "proto/report/failure.hpp"
#include "solid-server/element/deformation.hpp"
#include "solid-server/element/stabilisation.hpp"
#include "solid-server/element/volume_projection.hpp"

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

/// dxi_k/dX_J and volume at the points, then what the formulation needs of the whole element.
std::vector<double> geometry_at_points(const SolidMesh& mesh, const ElementBlock& block, Index element,
                                       const std::vector<QuadraturePoint>& points,
                                       const std::vector<TabulatedPoint>& table, ElementFormulation formulation) {
  const ElementVectors position = at_element(mesh.node_position, block.nodes_of(element));
  std::vector<double> geometry, volume;
  for (const TabulatedPoint& point : table) {
    const Eigen::Matrix3d J_at_point = jacobian(position, point), inverse = J_at_point.inverse();
    volume.push_back(J_at_point.determinant() * point.weight);
    if (!(volume.back() > 0)) refuse_folded(mesh, block.first_element + element);
    for (int k = 0; k < 3; ++k)
      for (int J = 0; J < 3; ++J) geometry.push_back(inverse(k, J));
    geometry.push_back(volume.back());
  }
  if (formulation == ElementFormulation::near_incompressible)
    for (const double entry : inverse_gram_matrix(block.shape, points, volume)) geometry.push_back(entry);
  return geometry;
}

std::vector<double> stabilised_geometry(const SolidMesh& mesh, const ElementBlock& block, Index element) {
  const ElementVectors position = at_element(mesh.node_position, block.nodes_of(element));
  for (const QuadraturePoint& point : element_quadrature(block.shape, 8))
    if (!(reference_point(block.shape, position, point).volume > 0)) refuse_folded(mesh, block.first_element + element);
  const auto geometry = stabilisation::geometry(position);
  return {geometry.begin(), geometry.end()};
}

/// Geometry of the eight elements of a pack.
std::vector<StoredPack> geometry_of(const SolidMesh& mesh, const ElementBlock& block,
                                    const std::array<Index, n_lanes>& elements,
                                    const std::vector<QuadraturePoint>& points,
                                    const std::vector<TabulatedPoint>& table, ElementFormulation formulation) {
  std::vector<StoredPack> geometry;
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    const auto of_element = formulation == ElementFormulation::stabilised
                                ? stabilised_geometry(mesh, block, elements[lane])
                                : geometry_at_points(mesh, block, elements[lane], points, table, formulation);
    geometry.resize(of_element.size());
    for (std::size_t n = 0; n < of_element.size(); ++n) geometry[n].lane[lane] = of_element[n];
  }
  return geometry;
}

/// Numbers of one kind that follow each other in the geometry of a pack: equal if they differ by little of the largest.
std::vector<std::size_t> sizes_of_kinds(ElementFormulation formulation, std::size_t n_points, std::size_t n_numbers) {
  if (formulation == ElementFormulation::stabilised) {
    using namespace stabilisation;
    return {position_at, frame_at - position_at, volume_at - frame_at, 1, 1, n_geometry - highest_at};
  }
  std::vector<std::size_t> sizes;
  for (std::size_t q = 0; q < n_points; ++q) sizes.insert(sizes.end(), {9, 1});
  if (n_numbers > 10 * n_points) sizes.push_back(n_numbers - 10 * n_points);
  return sizes;
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
bool are_alike(const std::vector<StoredPack>& a, const StoredPack* b, const std::vector<std::size_t>& sizes_of_kinds) {
  constexpr double round_off = 1e-12;
  std::size_t first = 0;
  for (const std::size_t n_kind : sizes_of_kinds) {
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      double size = 0, difference = 0;
      for (std::size_t n = first; n < first + n_kind; ++n) {
        size = std::max(size, std::abs(a[n].lane[lane]));
        difference = std::max(difference, std::abs(a[n].lane[lane] - b[n].lane[lane]));
      }
      if (difference > round_off * size) return false;
    }
    first += n_kind;
  }
  return true;
}

}  // namespace

ElementPacks make_element_packs(const SolidMesh& mesh, const ElementBlock& block, int n_points,
                                ElementFormulation formulation) {
  const auto points = element_quadrature(block.shape, n_points);
  const auto table = tabulate(block.shape, points);
  ElementPacks packs;
  packs.shape = block.shape;
  packs.formulation = formulation;
  packs.n_nodes = topology(block.shape).n_nodes;
  packs.n_points = n_points;
  packs.n_elements = block.n_elements();
  for (const QuadraturePoint& point : points) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> gradient = shape_gradient(block.shape, point.xi);
    packs.natural_gradient.insert(packs.natural_gradient.end(), gradient.data(), gradient.data() + gradient.size());
    if (formulation == ElementFormulation::near_incompressible)
      for (const double value : volume_functions(block.shape, point.xi)) packs.volume_function.push_back(value);
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

    const auto geometry = geometry_of(mesh, block, elements, points, table, formulation);
    if (per_layer > 0 && p >= per_layer) {
      const Index below = packs.geometry_start[static_cast<std::size_t>(p - per_layer)];
      const auto kinds = sizes_of_kinds(formulation, points.size(), geometry.size());
      if (are_alike(geometry, &packs.geometry[static_cast<std::size_t>(below)], kinds)) {
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
