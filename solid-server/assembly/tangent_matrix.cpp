#include "solid-server/assembly/tangent_matrix.hpp"

#include <algorithm>
#include <limits>

#include "solid-server/dynamics/work_team.hpp"
#include "solid-server/element/deformation.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/element/packed_tangent.hpp"

namespace couplet::solid {

namespace {

std::size_t at(Index n) {
  return static_cast<std::size_t>(n);
}

// Packs whose tangents are computed before they are added up: some 2 MB of hexahedra, for the shared cache.
constexpr Index packs_at_once = 16;

/// Places of pairs whose lower node comes second: the block is added as its transpose.
constexpr Index transposed(Index place) {
  return ~place;
}
constexpr Index no_place = std::numeric_limits<Index>::min();  // of copies that fill up a pack

}  // namespace

TangentMatrix::TangentMatrix(const SolidMesh& mesh, const std::vector<BlockProperties>& properties, MassForm mass_form,
                             WorkTeam& team)
    : team_(team), mesh_pairs_(element_pairs(mesh)), pairs_(mesh_pairs_) {
  blocks_.assign(9 * at(pairs_.n_pairs()), 0);
  mass_.assign(at(pairs_.n_pairs()), 0);
  std::size_t largest = 0;
  for (std::size_t b = 0; b < mesh.block.size(); ++b) {
    const BlockProperties& property = properties[b];
    blocks_of_elements_.push_back(
        {property.material, make_element_packs(mesh, mesh.block[b], property.n_points, property.formulation), {}});
    if (mass_form == MassForm::consistent) add_consistent_mass(mesh, mesh.block[b], property.density);
    largest = std::max(largest, 9 * at(n_local_pairs(blocks_of_elements_.back().elements.n_nodes)));
  }
  if (mass_form == MassForm::lumped) set_lumped_mass(mesh, properties);
  buffer_.resize(at(packs_at_once) * largest);
  find_places();
}

void TangentMatrix::find_places() {
  for (Block& block : blocks_of_elements_) {
    const ElementPacks& packs = block.elements;
    block.place.clear();
    const auto node = [&](Index p, int a, int lane) {
      return packs.node_start[at((p * packs.n_nodes + a) * n_lanes + lane)] / NodeVectors::ColsAtCompileTime;
    };
    for (Index p = 0; p < packs.n_packs; ++p)
      for (int b = 0; b < packs.n_nodes; ++b)
        for (int a = b; a < packs.n_nodes; ++a)
          for (int lane = 0; lane < n_lanes; ++lane) {
            const Index place = pairs_.find(node(p, a, lane), node(p, b, lane));
            const bool is_copy = packs.lane_element[at(p * n_lanes + lane)] < 0;
            const bool is_turned = node(p, a, lane) < node(p, b, lane);
            block.place.push_back(is_copy ? no_place : is_turned ? transposed(place) : place);
          }
  }
}

/// m_ab = sum over points of rho N_a N_b dV.
void TangentMatrix::add_consistent_mass(const SolidMesh& mesh, const ElementBlock& elements, double density) {
  const auto points = element_quadrature(elements.shape, n_mass_points(elements.shape));
  std::vector<ShapeValues<max_element_nodes>> shape;
  for (const QuadraturePoint& point : points) shape.push_back(shape_values(elements.shape, point.xi));
  for (Index element = 0; element < elements.n_elements(); ++element) {
    const auto nodes = elements.nodes_of(element);
    const ElementVectors position = at_element(mesh.node_position, nodes);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(position.rows(), position.rows());
    for (std::size_t q = 0; q < points.size(); ++q)
      mass.noalias() +=
          (density * reference_point(elements.shape, position, points[q]).volume * shape[q]) * shape[q].transpose();
    for (std::size_t b = 0; b < nodes.size(); ++b)
      for (std::size_t a = b; a < nodes.size(); ++a)
        mass_[at(pairs_.find(nodes[a], nodes[b]))] += mass(static_cast<Index>(a), static_cast<Index>(b));
  }
}

void TangentMatrix::set_lumped_mass(const SolidMesh& mesh, const std::vector<BlockProperties>& properties) {
  std::vector<double> density;
  for (const BlockProperties& property : properties) density.push_back(property.density);
  const Eigen::VectorXd mass = lumped_mass(mesh, density);
  for (Index node = 0; node < mesh.n_nodes(); ++node) mass_[at(pairs_.start[at(node)])] = mass[node];
}

Index TangentMatrix::assemble(const NodeVectors& displacement, const NodeVectors* increment, double stiffness,
                              double mass) {
  std::atomic<Index> inverted{-1};
  team_.run([&](int member) {
    const auto pairs = share_of(pairs_.n_pairs(), member, team_.n_members());
    for (Index p = pairs.first; p < pairs.last; ++p) {
      std::fill_n(&blocks_[9 * at(p)], 9, 0.0);
      for (const std::size_t diagonal : {0, 4, 8}) blocks_[9 * at(p) + diagonal] = mass * mass_[at(p)];
    }
    for (const Block& block : blocks_of_elements_) {
      const Index values_per_pack = 9 * n_local_pairs(block.elements.n_nodes);
      for (Index first = 0; first < block.elements.n_packs; first += packs_at_once) {
        const Index last = std::min(first + packs_at_once, block.elements.n_packs);
        const auto packs = share_of(last - first, member, team_.n_members());
        const Index found = packed_tangent(block.elements, block.material, first + packs.first, first + packs.last,
                                           displacement.data(), &buffer_[at(packs.first) * at(values_per_pack)],
                                           increment ? increment->data() : nullptr);
        Index known = inverted;
        while (found >= 0 && (known < 0 || found < known) && !inverted.compare_exchange_weak(known, found)) continue;
        team_.barrier();
        add_packs(block, first, last, buffer_.data(), pairs.first, pairs.last, stiffness);
        team_.barrier();
      }
    }
  });
  return inverted;
}

/// Adds the tangents of the packs [first, last) to the pairs [first_pair, last_pair).
void TangentMatrix::add_packs(const Block& block, Index first, Index last, const StoredPack* values, Index first_pair,
                              Index last_pair, double factor) {
  const Index n_pairs = n_local_pairs(block.elements.n_nodes);
  const Index* place = &block.place[at(first) * at(n_pairs * n_lanes)];
  for (Index n = 0; n < (last - first) * n_pairs; ++n, values += 9)
    for (int lane = 0; lane < n_lanes; ++lane, ++place) {
      const bool is_turned = *place < 0;
      const Index pair = is_turned ? transposed(*place) : *place;
      if (*place == no_place || pair < first_pair || pair >= last_pair) continue;
      double* sum = &blocks_[9 * at(pair)];
      if (is_turned)
        for (int c = 0; c < 9; ++c) sum[c] += factor * values[c % 3 * 3 + c / 3].lane[lane];
      else
        for (int c = 0; c < 9; ++c) sum[c] += factor * values[c].lane[lane];
    }
}

bool TangentMatrix::add_symmetric_part(Index a, Index b, const Eigen::Matrix3d& C) {
  const Index pair = pairs_.find(a, b);
  if (pair < 0) return false;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(&blocks_[9 * at(pair)]);
  if (a == b)
    block += 0.5 * (C + C.transpose());
  else if (a > b)
    block += 0.5 * C;
  else
    block += 0.5 * C.transpose();
  return true;
}

bool TangentMatrix::is_zero(Index a, Index b) const {
  const Index pair = pairs_.find(a, b);
  const auto first = blocks_.begin() + 9 * static_cast<std::ptrdiff_t>(pair);
  return pair < 0 || std::all_of(first, first + 9, [](double entry) { return entry == 0; });
}

void TangentMatrix::set_extra_pairs(const std::vector<std::pair<Index, Index>>& extra) {
  const NodePairs before = std::move(pairs_);
  const std::vector<double> blocks = std::move(blocks_), mass = std::move(mass_);
  pairs_ = with_extra_pairs(mesh_pairs_, extra);
  blocks_.assign(9 * at(pairs_.n_pairs()), 0);
  mass_.assign(at(pairs_.n_pairs()), 0);
  for (Index column = 0; column < before.n_nodes(); ++column)
    for (Index p = before.start[at(column)]; p < before.start[at(column) + 1]; ++p)
      if (const Index place = pairs_.find(before.row[at(p)], column); place >= 0) {
        mass_[at(place)] = mass[at(p)];
        std::copy_n(&blocks[9 * at(p)], 9, &blocks_[9 * at(place)]);
      }
  find_places();
}

NodeVectors TangentMatrix::multiply(const NodeVectors& vector) const {
  NodeVectors product = NodeVectors::Zero(vector.rows(), 4);
  for (Index column = 0; column < pairs_.n_nodes(); ++column)
    for (Index p = pairs_.start[at(column)]; p < pairs_.start[at(column) + 1]; ++p) {
      const Index row = pairs_.row[at(p)];
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(&blocks_[9 * at(p)]);
      product.row(row).head<3>().transpose() += block * vector.row(column).head<3>().transpose();
      if (row != column) product.row(column).head<3>() += vector.row(row).head<3>() * block;
    }
  return product;
}

NodeVectors TangentMatrix::mass_times(const NodeVectors& vector) const {
  NodeVectors product = NodeVectors::Zero(vector.rows(), 4);
  for (Index column = 0; column < pairs_.n_nodes(); ++column)
    for (Index p = pairs_.start[at(column)]; p < pairs_.start[at(column) + 1]; ++p) {
      const Index row = pairs_.row[at(p)];
      product.row(row).head<3>() += mass_[at(p)] * vector.row(column).head<3>();
      if (row != column) product.row(column).head<3>() += mass_[at(p)] * vector.row(row).head<3>();
    }
  return product;
}

std::size_t TangentMatrix::memory_bytes() const {
  std::size_t n_packs = buffer_.size(), n_indices = pairs_.row.size() + mesh_pairs_.row.size();
  for (const Block& block : blocks_of_elements_) {
    n_packs += block.elements.geometry.size() + block.elements.axes.size();
    n_indices += block.elements.node_start.size() + block.place.size();
  }
  return n_packs * sizeof(StoredPack) + n_indices * sizeof(Index) + (blocks_.size() + mass_.size()) * sizeof(double);
}

}  // namespace couplet::solid
