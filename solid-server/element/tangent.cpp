#include "solid-server/element/tangent.hpp"

namespace couplet::solid {

namespace {

/// Calls visit(reference point, F, material) at every point.
template <class Visit>
void at_points(const Material& material, const ElementVectors& position, const ElementVectors& displacement,
               int n_points, const Visit& visit) {
  for (const QuadraturePoint& point : element_quadrature(n_points)) {
    const ReferencePoint reference = reference_point(position, point);
    const Tensor<double> F = deformation_gradient(displacement, reference);
    std::visit([&](const auto& law) { visit(reference, F, law); }, material);
  }
}

}  // namespace

ElementTangent element_tangent(const Material& material, const ElementVectors& position,
                               const ElementVectors& displacement, int n_points) {
  ElementTangent stiffness = ElementTangent::Zero();
  at_points(material, position, displacement, n_points,
            [&](const ReferencePoint& point, const auto& F, const auto& law) {
              Eigen::Matrix<double, 9, 3 * hex20::n_nodes> derivative;  // dF_iJ by the displacements
              derivative.setZero();
              for (int a = 0; a < hex20::n_nodes; ++a)
                for (int i = 0; i < 3; ++i)
                  for (int J = 0; J < 3; ++J) derivative(3 * i + J, 3 * a + i) = point.gradient(a, J);
              stiffness.noalias() += derivative.transpose() * (as_matrix(law.tangent(F)) * point.volume) * derivative;
            });
  return stiffness;
}

double element_energy(const Material& material, const ElementVectors& position, const ElementVectors& displacement,
                      int n_points) {
  double energy = 0;
  at_points(
      material, position, displacement, n_points,
      [&](const ReferencePoint& point, const auto& F, const auto& law) { energy += law.energy(F) * point.volume; });
  return energy;
}

ElementVectors element_force(const Material& material, const ElementVectors& position,
                             const ElementVectors& displacement, int n_points) {
  ElementVectors force = ElementVectors::Zero();
  at_points(material, position, displacement, n_points,
            [&](const ReferencePoint& point, const auto& F, const auto& law) {
              const Tensor<double> P = law.stress(F);
              const auto stress = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&P.at[0][0]);
              force.noalias() -= point.volume * point.gradient * stress.transpose();
            });
  return force;
}

}  // namespace couplet::solid
