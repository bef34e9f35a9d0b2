#include "solid-server/output/tissue_fields.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "proto/report/failure.hpp"
#include "solid-server/element/point_state.hpp"

namespace couplet::solid {

namespace {

// Columns of what is averaged at nodes.
constexpr Eigen::Index stress_at = 0, ratio_at = 6, stretch_at = 7, n_columns = 8;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, n_columns, Eigen::RowMajor>;

constexpr int component[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

Eigen::Matrix3d stress_tensor(const Columns& columns, Eigen::Index row) {
  Eigen::Matrix3d stress;
  for (int n = 0; n < 6; ++n)
    stress(component[n][0], component[n][1]) = stress(component[n][1], component[n][0]) = columns(row, stress_at + n);
  return stress;
}

/// All nine numbers of the stress, row by row.
surface::NodeArray tensor_rows(const Columns& columns) {
  surface::NodeArray rows(columns.rows(), 9);
  for (Eigen::Index n = 0; n < columns.rows(); ++n) rows.row(n) = stress_tensor(columns, n).reshaped().transpose();
  return rows;
}

/// sqrt(3/2 s : s), s = sigma - tr sigma/3 I.
double von_mises(const Eigen::Matrix3d& stress) {
  return std::sqrt(1.5) * (stress - stress.trace() / 3 * Eigen::Matrix3d::Identity()).norm();
}

double largest_principal(const Eigen::Matrix3d& stress) {
  if (!stress.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stress, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

bool has_fibres(const Material& material) {
  return std::visit([](const auto& law) { return law.is_anisotropic; }, material);
}

LocalAxes<double> axes_of(const ElementBlock& block, Index element) {
  LocalAxes<double> axes{};
  if (block.axes.empty()) return axes;
  for (std::size_t n = 0; n < 2; ++n)
    for (int J = 0; J < 3; ++J) axes.at[n][J] = block.axes[static_cast<std::size_t>(element)][n][J];
  return axes;
}

/// F m of the first family; empty: the law has no fibres.
std::optional<Eigen::Vector3d> fibre(const PlainElement& element, const Eigen::Matrix3d& F) {
  return std::visit(
      [&]<class Law>(const Law& law) -> std::optional<Eigen::Vector3d> {
        if constexpr (Law::is_anisotropic) {
          Tensor<double> gradient;
          for (int i = 0; i < 3; ++i)
            for (int J = 0; J < 3; ++J) gradient.at[i][J] = F(i, J);
          const Fibre<double> found = law.first_fibre(gradient, element.axes);
          return Eigen::Vector3d(found.f[0], found.f[1], found.f[2]);
        } else {
          return std::nullopt;
        }
      },
      element.material);
}

Columns columns_of(const PlainElement& element, const std::vector<PointState>& states) {
  Columns columns(static_cast<Eigen::Index>(states.size()), n_columns);
  for (Eigen::Index q = 0; q < columns.rows(); ++q) {
    const PointState& state = states[static_cast<std::size_t>(q)];
    for (int n = 0; n < 6; ++n) columns(q, stress_at + n) = state.cauchy(component[n][0], component[n][1]);
    columns(q, ratio_at) = state.volume_ratio;
    const auto along = fibre(element, state.F);
    columns(q, stretch_at) = along ? along->norm() : std::numeric_limits<double>::quiet_NaN();
  }
  return columns;
}

/// By the mean of F over the points.
Eigen::Vector3d fibre_direction(const PlainElement& element, const std::vector<PointState>& states) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PointState& state : states) sum += state.F;
  const auto along = fibre(element, sum);
  return along ? along->normalized() : Eigen::Vector3d::Zero();
}

}  // namespace

TissueFields::TissueFields(const SolidMesh& mesh, const std::vector<BlockProperties>& properties,
                           std::vector<TissueField> wanted)
    : mesh_(mesh), properties_(properties), wanted_(std::move(wanted)) {
  if ((is_wanted(TissueField::fibre_stretch) || is_wanted(TissueField::fibre_direction)) &&
      std::none_of(properties.begin(), properties.end(), [](const auto& p) { return has_fibres(p.material); }))
    throw report::SceneError("solid.field", "no material has fibres, so there is no FIBRE_STRETCH or FIBRE_DIRECTION",
                             "leave these fields out, or give holzapfel_gasser_ogden or may_newman");
  nodes_ = needs_nodes() ? nodes_by_region(mesh) : shared_nodes(mesh);
  n_elements_ = Eigen::VectorXd::Zero(nodes_.n_nodes());
  for (const auto& block : nodes_.block)
    for (const Index node : block) n_elements_[node] += 1;
}

bool TissueFields::is_wanted(TissueField field) const {
  return std::find(wanted_.begin(), wanted_.end(), field) != wanted_.end();
}

bool TissueFields::needs_nodes() const {
  return std::any_of(wanted_.begin(), wanted_.end(), [](auto field) { return field != TissueField::fibre_direction; });
}

TissueState TissueFields::at(const NodeVectors& displacement) const {
  if (wanted_.empty()) return {};
  Columns sum = Columns::Zero(nodes_.n_nodes(), n_columns);
  NodePositions direction = NodePositions::Zero(mesh_.n_elements(), 3);
  for (std::size_t b = 0; b < mesh_.block.size(); ++b) {
    const ElementBlock& block = mesh_.block[b];
    const BlockProperties& properties = properties_[b];
    const Eigen::MatrixXd to_nodes = points_to_nodes(block.shape, properties.n_points);
    const Eigen::Index n_nodes = to_nodes.rows();
    for (Index e = 0; e < block.n_elements(); ++e) {
      const auto nodes = block.nodes_of(e);
      const PlainElement element{properties.material, block.shape, properties.n_points,
                                 at_element(mesh_.node_position, nodes), axes_of(block, e)};
      const auto states = point_states(element, properties.formulation, at_element(displacement, nodes));
      const Columns at_nodes = to_nodes * columns_of(element, states);
      for (Eigen::Index a = 0; a < n_nodes; ++a)
        sum.row(nodes_.block[b][static_cast<std::size_t>(e * n_nodes + a)]) += at_nodes.row(a);
      direction.row(block.first_element + e) = fibre_direction(element, states);
    }
  }
  // A node that no element has keeps zeros.
  const Columns mean = n_elements_.cwiseMax(1).cwiseInverse().asDiagonal() * sum;

  const auto of_stress = [&](double (*measure)(const Eigen::Matrix3d&)) {
    surface::NodeArray values(mean.rows(), 1);
    for (Eigen::Index n = 0; n < mean.rows(); ++n) values(n, 0) = measure(stress_tensor(mean, n));
    return values;
  };
  TissueState state;
  for (const TissueField field : wanted_) switch (field) {
      case TissueField::cauchy_stress:
        state.at_nodes.push_back({"cauchy_stress", "Pa", tensor_rows(mean)});
        break;
      case TissueField::largest_principal_stress:
        state.at_nodes.push_back({"largest_principal_stress", "Pa", of_stress(largest_principal)});
        break;
      case TissueField::von_mises_stress:
        state.at_nodes.push_back({"von_mises_stress", "Pa", of_stress(von_mises)});
        break;
      case TissueField::volume_ratio:
        state.at_nodes.push_back({"volume_ratio", "1", mean.col(ratio_at)});
        break;
      case TissueField::fibre_stretch:
        state.at_nodes.push_back({"fibre_stretch", "1", mean.col(stretch_at)});
        break;
      case TissueField::fibre_direction:
        state.of_elements.push_back({"fibre_direction", "1", direction});
        break;
    }
  return state;
}

}  // namespace couplet::solid
