// Stress at nodes against an exact solution: a thick sphere under internal pressure.

#include <gtest/gtest.h>

#include <cmath>

#include "solid-server/mesh/parametric/hollow_sphere_mesh.hpp"
#include "solid-server/output/tissue_fields.hpp"
#include "solid-server/solid_model.hpp"
#include "tests/unit/solid-server/element/meshes_of_shapes.hpp"

namespace couplet::solid {
namespace {

constexpr double inner = 1e-3, outer = 2e-3, young = 1e5, pressure = 1e-2;  // [m] [m] [Pa] [Pa]

/// [Timoshenko, Goodier 1970, 136]: sigma_r = k (1 - b^3/r^3), sigma_t = k (1 + b^3/(2 r^3)), k = p a^3/(b^3 - a^3).
Eigen::Matrix3d exact_stress(const Eigen::Vector3d& X) {
  const double r = X.norm(), ratio = std::pow(outer / r, 3), k = pressure / (std::pow(outer / inner, 3) - 1);
  const Eigen::Matrix3d radial = X * X.transpose() / (r * r);
  return k * (1 - ratio) * radial + k * (1 + ratio / 2) * (Eigen::Matrix3d::Identity() - radial);
}

struct Errors {
  double largest = 0, mean = 0;  // of the stress over the pressure; root of the mean square over the nodes
};

/// Small strains: the law is linear to the order of p/E = 1e-7.
Errors errors(ElementShape shape, ElementFormulation formulation, int n_points, double poisson, int n) {
  SolidSetup setup;
  setup.mesh = in_shape(make_hollow_sphere_mesh({inner, outer, n, n}), shape);
  setup.properties = {{NeoHookean::from_young(young, poisson), 1000, n_points, formulation}};
  setup.supports.symmetry = {{"x_min", 0}, {"y_min", 1}, {"z_min", 2}};
  setup.pressures = {{"inner", [](double time) { return pressure * time; }}};
  setup.method = TimeMethod::static_equilibrium;
  const SolidMesh mesh = setup.mesh;
  const std::vector<BlockProperties> properties = setup.properties;
  SolidModel model(std::move(setup));
  model.solve_step(1, surface::NodeArray::Zero(0, 3));
  model.accept_step();
  const TissueFields fields(mesh, properties, {TissueField::cauchy_stress});
  const auto stress = fields.at(model.accepted().motion.displacement).at_nodes.front().values;
  Errors found;
  for (Index node = 0; node < mesh.n_nodes(); ++node) {
    const Eigen::Matrix3d exact = exact_stress(mesh.node_position.row(node));
    const Eigen::Matrix3d difference = Eigen::Matrix3d(stress.row(node).reshaped(3, 3)) - exact;
    found.largest = std::max(found.largest, difference.cwiseAbs().maxCoeff() / pressure);
    found.mean += difference.squaredNorm() / pressure / pressure / static_cast<double>(mesh.n_nodes());
  }
  found.mean = std::sqrt(found.mean);
  return found;
}

void expect_order(const char* name, ElementShape shape, ElementFormulation formulation, int n_points, double poisson,
                  int n, double order) {
  const Errors coarse = errors(shape, formulation, n_points, poisson, n),
               fine = errors(shape, formulation, n_points, poisson, 2 * n);
  const double of_mean = std::log2(coarse.mean / fine.mean), of_largest = std::log2(coarse.largest / fine.largest);
  std::printf("%-36s nu %-6g n %2d, %2d: mean %.2e, %.2e, order %.2f; largest %.2e, %.2e, order %.2f\n", name, poisson,
              n, 2 * n, coarse.mean, fine.mean, of_mean, coarse.largest, fine.largest, of_largest);
  EXPECT_GE(of_mean, order) << name;
}

// The functions that carry stress to nodes are linear along each axis, so the order is two where elements are; an
// element with one point says the same at all its nodes: order one at the boundary, more inside.
TEST(StressAtNodes, ConvergesInAThickSphere) {
  using enum ElementShape;
  using enum ElementFormulation;
  expect_order("hexahedron20, 8 points", hexahedron20, standard, 8, 0.3, 2, 1.7);
  expect_order("hexahedron20, 27 points", hexahedron20, standard, 27, 0.3, 2, 1.7);
  expect_order("hexahedron20, near-incompressible", hexahedron20, near_incompressible, 27, 0.4999, 2, 1.7);
  expect_order("tetrahedron10", tetrahedron10, standard, 4, 0.3, 2, 1.2);
  expect_order("hexahedron8, stabilised", hexahedron8, stabilised, 1, 0.3, 4, 0.9);
}

}  // namespace
}  // namespace couplet::solid
