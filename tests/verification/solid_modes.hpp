#pragma once
// Frequencies of free vibration of a body about its rest state, for tests.

#include <Spectra/SymGEigsShiftSolver.h>

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "solid-server/assembly/block_properties.hpp"
#include "solid-server/element/hex20.hpp"
#include "solid-server/element/mass.hpp"
#include "solid-server/element/tangent.hpp"
#include "solid-server/support/supports.hpp"

namespace couplet::solid {

using SparseMatrix = Eigen::SparseMatrix<double>;

struct FreeVibration {
  SparseMatrix stiffness, lumped_mass, consistent_mass;  // on the free degrees of freedom
};

/// M_ab = sum over 27 points of rho N_a N_b dV, the same for each component.
inline ElementTangent consistent_mass(const ElementVectors& position, double density) {
  ElementTangent mass = ElementTangent::Zero(3 * hex20::n_nodes, 3 * hex20::n_nodes);
  for (const QuadraturePoint& point : element_quadrature(ElementShape::hexahedron20, 27)) {
    const auto N = hex20::shape(point.xi);
    const double at_point = density * reference_point(ElementShape::hexahedron20, position, point).volume;
    for (int a = 0; a < hex20::n_nodes; ++a)
      for (int b = 0; b < hex20::n_nodes; ++b)
        for (int i = 0; i < 3; ++i) mass(3 * a + i, 3 * b + i) += at_point * N[a] * N[b];
  }
  return mass;
}

inline FreeVibration free_vibration(const SolidMesh& mesh, const BlockProperties& properties,
                                    const Supports& supports) {
  const double density = properties.density;
  const Eigen::VectorXd lumped = lumped_mass(mesh, {density});
  const NodeVectors inverse = inverse_mass(mesh, lumped, supports);
  std::vector<int> equation(static_cast<std::size_t>(3 * mesh.n_nodes()), -1);
  std::vector<Eigen::Triplet<double>> stiffness, mass, diagonal;
  int n_free = 0;
  for (Index n = 0; n < mesh.n_nodes(); ++n)
    for (int i = 0; i < 3; ++i)
      if (inverse(n, i) > 0) {
        diagonal.emplace_back(n_free, n_free, lumped[n]);
        equation[static_cast<std::size_t>(3 * n + i)] = n_free++;
      }
  for (Index element = 0; element < mesh.n_elements(); ++element) {
    const auto nodes = mesh.nodes_of(element);
    const ElementVectors position = at_element(mesh.node_position, nodes);
    const ElementTangent K =
        element_tangent({properties.material, ElementShape::hexahedron20, properties.n_points, position},
                        ElementVectors::Zero(hex20::n_nodes, 3));
    const ElementTangent M = consistent_mass(position, density);
    const auto equation_of = [&](int row) {
      return equation[static_cast<std::size_t>(3 * nodes[static_cast<std::size_t>(row / 3)] + row % 3)];
    };
    for (int row = 0; row < K.rows(); ++row)
      for (int column = 0; column < K.cols(); ++column) {
        const int r = equation_of(row), c = equation_of(column);
        if (r < 0 || c < 0) continue;
        stiffness.emplace_back(r, c, K(row, column));
        if (row % 3 == column % 3) mass.emplace_back(r, c, M(row, column));
      }
  }
  const auto matrix = [&](const std::vector<Eigen::Triplet<double>>& entries) {
    SparseMatrix out(n_free, n_free);
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
  };
  return {matrix(stiffness), matrix(diagonal), matrix(mass)};
}

/// K^-1 for Spectra, by Eigen's sparse factorisation.
class StiffnessInverse {
 public:
  using Scalar = double;
  explicit StiffnessInverse(const SparseMatrix& stiffness) : factors_(stiffness) {}
  Eigen::Index rows() const { return factors_.rows(); }
  Eigen::Index cols() const { return factors_.cols(); }
  void set_shift(double) {}  // always 0
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) = factors_.solve(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }

 private:
  Eigen::SimplicialLDLT<SparseMatrix> factors_;
};

class MassProduct {
 public:
  using Scalar = double;
  explicit MassProduct(const SparseMatrix& mass) : mass_(mass) {}
  Eigen::Index rows() const { return mass_.rows(); }
  Eigen::Index cols() const { return mass_.cols(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) = mass_ * Eigen::Map<const Eigen::VectorXd>(in, rows());
  }

 private:
  const SparseMatrix& mass_;
};

/// The lowest frequencies of K phi = omega^2 M phi, rising [Hz].
inline std::vector<double> lowest_frequencies(const SparseMatrix& stiffness, const SparseMatrix& mass,
                                              int n_frequencies) {
  StiffnessInverse inverse(stiffness);
  MassProduct product(mass);
  Spectra::SymGEigsShiftSolver<StiffnessInverse, MassProduct, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, product, n_frequencies, 4 * n_frequencies, 0.0);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn);
  std::vector<double> frequencies;
  for (const double squared : solver.eigenvalues()) frequencies.push_back(std::sqrt(squared) / (2 * std::numbers::pi));
  std::sort(frequencies.begin(), frequencies.end());
  return frequencies;
}

}  // namespace couplet::solid
