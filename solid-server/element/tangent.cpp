#include "solid-server/element/tangent.hpp"

namespace couplet::solid {

namespace {

/// Calls visit(reference point, F, law) at every point.
template <class Visit>
void at_points(const PlainElement& element, const ElementVectors& displacement, const Visit& visit) {
  for (const QuadraturePoint& point : element_quadrature(element.shape, element.n_points)) {
    const ReferencePoint reference = reference_point(element.shape, element.position, point);
    const Tensor<double> F = deformation_gradient(displacement, reference);
    std::visit([&](const auto& law) { visit(reference, F, law); }, element.material);
  }
}

}  // namespace

ElementTangent element_tangent(const PlainElement& element, const ElementVectors& displacement) {
  const Eigen::Index n_nodes = displacement.rows();
  ElementTangent stiffness = ElementTangent::Zero(3 * n_nodes, 3 * n_nodes);
  at_points(element, displacement, [&](const ReferencePoint& point, const auto& F, const auto& law) {
    Eigen::Matrix<double, 9, Eigen::Dynamic> derivative(9, 3 * n_nodes);  // dF_iJ by the displacements
    derivative.setZero();
    for (Eigen::Index a = 0; a < n_nodes; ++a)
      for (int i = 0; i < 3; ++i)
        for (int J = 0; J < 3; ++J) derivative(3 * i + J, 3 * a + i) = point.gradient(a, J);
    const Tangent slope = as_matrix(tangent_of(law, F, element.axes));
    stiffness.noalias() += derivative.transpose() * (slope * point.volume) * derivative;
  });
  return stiffness;
}

double element_energy(const PlainElement& element, const ElementVectors& displacement) {
  double energy = 0;
  at_points(element, displacement, [&](const ReferencePoint& point, const auto& F, const auto& law) {
    energy += energy_of(law, F, element.axes) * point.volume;
  });
  return energy;
}

ElementVectors element_force(const PlainElement& element, const ElementVectors& displacement) {
  ElementVectors force = ElementVectors::Zero(displacement.rows(), 3);
  at_points(element, displacement, [&](const ReferencePoint& point, const auto& F, const auto& law) {
    const Tensor<double> P = stress_of(law, F, element.axes);
    const auto stress = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&P.at[0][0]);
    force.noalias() -= point.volume * point.gradient * stress.transpose();
  });
  return force;
}

}  // namespace couplet::solid
