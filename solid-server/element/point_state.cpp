#include "solid-server/element/point_state.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "solid-server/element/volume_projection.hpp"

namespace couplet::solid {

namespace {

using RowMatrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Matrix3d matrix(const Tensor<double>& t) {
  return Eigen::Map<const RowMatrix>(&t.at[0][0]);
}

Tensor<double> tensor(const Eigen::Matrix3d& m) {
  Tensor<double> t;
  Eigen::Map<RowMatrix>(&t.at[0][0]) = m;
  return t;
}

/// sigma = P F^T / det F.
template <class Law>
Eigen::Matrix3d cauchy_stress(const Law& law, const Eigen::Matrix3d& F, const LocalAxes<double>& axes) {
  return matrix(stress_of(law, tensor(F), axes)) * F.transpose() / F.determinant();
}

struct Points {
  std::vector<QuadraturePoint> natural;
  std::vector<double> volume;  // dV [m^3]
  std::vector<Eigen::Matrix3d> F;
};

Points points_of(const PlainElement& element, int n_points, const ElementVectors& displacement) {
  Points points;
  points.natural = element_quadrature(element.shape, n_points);
  for (const QuadraturePoint& point : points.natural) {
    const ReferencePoint reference = reference_point(element.shape, element.position, point);
    points.volume.push_back(reference.volume);
    points.F.push_back(matrix(deformation_gradient(displacement, reference)));
  }
  return points;
}

std::vector<PointState> standard_states(const PlainElement& element, const Points& points) {
  std::vector<PointState> states;
  std::visit(
      [&](const auto& law) {
        for (const Eigen::Matrix3d& F : points.F)
          states.push_back({F, F.determinant(), cauchy_stress(law, F, element.axes)});
      },
      element.material);
  return states;
}

/// As near_incompressible_force.cpp has it:  Jbar = phi . M^-1 sum of phi J dV,  p = phi . M^-1 sum of phi U'(Jbar) dV.
std::vector<PointState> near_incompressible_states(const PlainElement& element, const Points& points) {
  const auto n_points = static_cast<Eigen::Index>(points.F.size());
  const int n_functions = n_volume_functions(topology(element.shape).n_nodes);
  Eigen::MatrixXd phi(n_points, n_functions);
  Eigen::VectorXd volume(n_points), J(n_points);
  for (Eigen::Index q = 0; q < n_points; ++q) {
    const auto at = static_cast<std::size_t>(q);
    phi.row(q) = volume_functions(element.shape, points.natural[at].xi);
    volume[q] = points.volume[at];
    J[q] = points.F[at].determinant();
  }
  const Eigen::LLT<Eigen::MatrixXd> gram(phi.transpose() * volume.asDiagonal() * phi);
  const auto projected = [&](const Eigen::VectorXd& values) -> Eigen::VectorXd {
    return phi * gram.solve(phi.transpose() * volume.cwiseProduct(values));
  };
  const Eigen::VectorXd Jbar = projected(J);

  std::vector<PointState> states;
  std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (Law::has_volumetric_part) {
          const double share = pointwise_share(n_functions, law.shear_modulus(), law.bulk_modulus_at_rest());
          const auto pressure_at = [&](double ratio) { return law.volumetric_part().pressure(ratio); };
          const Eigen::VectorXd pressure = projected(Jbar.unaryExpr(pressure_at));
          const Law isochoric = law.without_volumetric_part();
          for (Eigen::Index q = 0; q < n_points; ++q) {
            const Eigen::Matrix3d& F = points.F[static_cast<std::size_t>(q)];
            const double p = (1 - share) * pressure[q] + share * pressure_at(J[q]);
            states.push_back({F, (1 - share) * Jbar[q] + share * J[q],
                              cauchy_stress(isochoric, F, element.axes) + p * Eigen::Matrix3d::Identity()});
          }
        } else {
          __builtin_unreachable();  // refused by check_formulation
        }
      },
      element.material);
  return states;
}

/// The mean of F by 2 x 2 x 2 points is that of stabilisation::geometry.
Points mean_of(const Points& points) {
  Points mean;
  double volume = 0;
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  for (std::size_t q = 0; q < points.F.size(); ++q) {
    F += points.volume[q] * points.F[q];
    volume += points.volume[q];
  }
  mean.F.push_back(F / volume);
  return mean;
}

/// The functions that carry numbers from points to nodes, at a point.
Eigen::VectorXd carrying_functions(ElementShape shape, int n_points, const Eigen::Vector3d& xi) {
  if (n_points == 1) return Eigen::VectorXd::Ones(1);
  const double x = xi.x(), y = xi.y(), z = xi.z();
  if (shape == ElementShape::tetrahedron10) return Eigen::Vector4d(1, x, y, z);
  return Eigen::Vector<double, 8>(1, x, y, z, y * z, z * x, x * y, x * y * z);
}

}  // namespace

std::vector<PointState> point_states(const PlainElement& element, ElementFormulation formulation,
                                     const ElementVectors& displacement) {
  switch (formulation) {
    case ElementFormulation::standard:
      return standard_states(element, points_of(element, element.n_points, displacement));
    case ElementFormulation::near_incompressible:
      return near_incompressible_states(element, points_of(element, element.n_points, displacement));
    case ElementFormulation::stabilised:
      return standard_states(element, mean_of(points_of(element, 8, displacement)));
  }
  __builtin_unreachable();
}

Eigen::MatrixXd points_to_nodes(ElementShape shape, int n_points) {
  const ElementTopology& t = topology(shape);
  const auto points = element_quadrature(shape, n_points);
  const Eigen::Index n_functions = carrying_functions(shape, n_points, Eigen::Vector3d::Zero()).size();
  Eigen::MatrixXd at_points(n_points, n_functions), at_nodes(t.n_nodes, n_functions);
  Eigen::VectorXd weight(n_points);
  for (Eigen::Index q = 0; q < n_points; ++q) {
    const QuadraturePoint& point = points[static_cast<std::size_t>(q)];
    at_points.row(q) = carrying_functions(shape, n_points, point.xi);
    weight[q] = point.weight;
  }
  for (Eigen::Index a = 0; a < t.n_nodes; ++a) {
    const auto& xi = t.coordinate[static_cast<std::size_t>(a)];
    at_nodes.row(a) = carrying_functions(shape, n_points, {xi[0], xi[1], xi[2]});
  }
  const Eigen::MatrixXd weighted = at_points.transpose() * weight.asDiagonal();
  return at_nodes * (weighted * at_points).ldlt().solve(weighted);
}

}  // namespace couplet::solid
