// Claims about static equilibrium: slender bending in few iterations, limit points, prescribed displacements.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "proto/report/failure.hpp"
#include "solid-server/element/quadrature.hpp"
#include "solid-server/element/shape_functions.hpp"
#include "solid-server/mesh/parametric/annulus_mesh.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/mesh/parametric/hollow_sphere_mesh.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {
namespace {

void advance(SolidModel& model, double duration) {
  model.solve_step(duration, surface::NodeArray::Zero(model.accepted().motion.interface_force.rows(), 3));
  model.accept_step();
}

SolidSetup static_setup(const Material& material, int n_points) {
  SolidSetup setup;
  BlockProperties properties;
  properties.material = material;
  properties.density = 1000;
  properties.n_points = n_points;
  setup.properties = {properties};
  setup.method = TimeMethod::static_equilibrium;
  return setup;
}

/// 10 x 1 x 0.1 m, E = 1.2 MPa, nu = 0, clamped, end shear force 4 N: the tip moves to u = -3.28951 m, w = 6.70013 m
/// (Reissner beam, computed with its shear and axial stiffness).
struct Cantilever {
  SolidModel model;
  Cantilever(std::array<int, 3> n_elements, int n_points) : model(setup(n_elements, n_points)) {}

  static SolidSetup setup(std::array<int, 3> n_elements, int n_points) {
    SolidSetup setup = static_setup(SaintVenantKirchhoff::from_young(1.2e6, 0), n_points);
    setup.mesh = make_box_mesh({{10, 1, 0.1}, n_elements});
    setup.supports.fixed = {"x_min"};
    setup.tractions = {{"x_max", [](double t) { return Eigen::Vector3d(0, 0, 4 * t / 0.1); }}};
    return setup;
  }

  Eigen::Vector3d tip() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int n_nodes = 0;
    for (const Index node : model.mesh().find_nodes("x_max", "test")) {
      sum += model.accepted().motion.displacement.row(node).head<3>();
      ++n_nodes;
    }
    return sum / n_nodes;  // the section stays plane and the nodes lie symmetrically
  }
};

TEST(CantileverUnderEndShear, TakesFewIterationsInOneStepOfTheWholeLoad) {
  Cantilever beam({16, 2, 1}, 8);
  advance(beam.model, 1);
  const StepWork& work = beam.model.work_of_last_step();
  const Eigen::Vector3d tip = beam.tip();
  std::printf("16x2x1, 8 points: tip %.5f %.5f, %ld iterations, %ld factorisations, residual %.0e\n", tip.x(), tip.z(),
              work.n_iterations, work.n_factorisations, work.residual);
  EXPECT_NEAR(tip.x(), -3.28951, 2e-4 * 3.28951);
  EXPECT_NEAR(tip.z(), 6.70013, 2e-4 * 6.70013);
  EXPECT_LE(work.n_iterations, 40);
  EXPECT_LE(work.n_iterations, 10);  // what it is now
  EXPECT_EQ(work.n_negative_pivots, 0);
  EXPECT_NEAR(beam.model.reactions()[0].force.z(), -4, 1e-6);
}

TEST(CantileverUnderEndShear, ConvergesWithOneElementAcross) {
  // With 14 points; with 8 a single row of elements has mechanisms of zero energy. Full integration locks by 1.5 %.
  Cantilever beam({16, 1, 1}, 14);
  advance(beam.model, 1);
  const StepWork& work = beam.model.work_of_last_step();
  const Eigen::Vector3d tip = beam.tip();
  std::printf("16x1x1, 14 points: tip %.5f %.5f, %ld iterations\n", tip.x(), tip.z(), work.n_iterations);
  EXPECT_NEAR(tip.x(), -3.28951, 0.02 * 3.28951);
  EXPECT_LE(work.n_iterations, 10);

  Cantilever loose({16, 1, 1}, 8);
  try {
    advance(loose.model, 1);
    ADD_FAILURE();
  } catch (const report::NumericsError& error) {
    EXPECT_NE(error.sentence().find("singular"), std::string::npos);
  }
}

TEST(CantileverUnderEndShear, ReachesTheSameStateInManySteps) {
  Cantilever at_once({16, 2, 1}, 8), in_steps({16, 2, 1}, 8);
  advance(at_once.model, 1);
  for (int n = 0; n < 8; ++n) advance(in_steps.model, 0.125);
  std::printf("16x2x1 in 8 steps: %ld iterations, %ld factorisations\n", in_steps.model.total_work().n_iterations,
              in_steps.model.total_work().n_factorisations);
  EXPECT_LE((at_once.tip() - in_steps.tip()).norm(), 1e-5);  // residuals of 1e-7 of the clamp's forces
  EXPECT_LE(in_steps.model.total_work().n_iterations, 40);
}

struct Bending {
  const char* name;
  Material material;
  ElementFormulation formulation;
  int n_points;
};

TEST(SlenderBending, TakesFewIterationsForNearlyIncompressibleTissue) {
  // As above with Poisson's ratio 0.4999, in four steps. Iterations: 16 to 21; without the step in the tangent 680 to
  // 800.
  const auto standard = ElementFormulation::standard, projected = ElementFormulation::near_incompressible;
  const Material saint_venant_kirchhoff = SaintVenantKirchhoff::from_young(1.2e6, 0.4999);
  const Material neo_hookean = NeoHookean::from_young(1.2e6, 0.4999);
  for (const Bending& kind : {Bending{"Saint Venant-Kirchhoff, 27 points", saint_venant_kirchhoff, standard, 27},
                              Bending{"neo-Hooke, 8 points", neo_hookean, standard, 8},
                              Bending{"neo-Hooke, 27 points", neo_hookean, standard, 27},
                              Bending{"neo-Hooke, near-incompressible", neo_hookean, projected, 8}}) {
    SolidSetup setup = Cantilever::setup({16, 2, 1}, kind.n_points);
    setup.properties[0].material = kind.material;
    setup.properties[0].formulation = kind.formulation;
    SolidModel beam(setup);
    for (int n = 0; n < 4; ++n) advance(beam, 0.25);
    std::printf("0.4999, %s: %ld iterations, lift %.4f\n", kind.name, beam.total_work().n_iterations,
                beam.accepted().motion.displacement.col(2).maxCoeff());
    EXPECT_LE(beam.total_work().n_iterations, 40) << kind.name;
    EXPECT_EQ(beam.total_work().n_negative_pivots, 0);
  }
}

/// Pressures [Pa] at which the inner radius of an incompressible Mooney-Rivlin wall (a10 = 2.29, a01 = 0.25 kPa, from 1
/// to 2 mm) is 1.1, 1.25, 1.5 and 2 mm: integrals of the radial equilibrium.
struct ThickWall {
  const char* name;
  std::array<double, 5> pressure;
  SolidMesh mesh;
  std::vector<SymmetrySurface> symmetry;
};

TEST(ThickWall, IsInflatedInFewIterationsAtABulkModulusOf5000ShearModuli) {
  const ThickWall walls[] = {
      {"cylinder",
       {0, 668.336, 1400.615, 2175.400, 2916.192},
       make_annulus_mesh({.length = 0.5e-3, .angle = std::numbers::pi / 2, .n_elements = {4, 8, 1}}),
       {{"start", 1}, {"end", 0}, {"z_min", 2}, {"z_max", 2}}},
      {"sphere",
       {0, 1475.01, 2883.18, 4067.58, 4666.45},
       make_hollow_sphere_mesh({.n_radial = 3, .n_around = 3}),
       {{"x_min", 0}, {"y_min", 1}, {"z_min", 2}}}};
  const double radius[] = {1, 1.1, 1.25, 1.5, 2};
  for (const ThickWall& wall : walls) {
    SolidSetup setup = static_setup(MooneyRivlin{2290, 250, 5000 * 2 * 2540}, 27);
    setup.mesh = wall.mesh;
    setup.properties.resize(wall.mesh.block.size(), setup.properties[0]);
    for (BlockProperties& block : setup.properties) block.formulation = ElementFormulation::near_incompressible;
    setup.supports.symmetry = wall.symmetry;
    setup.pressures = {{"inner", [&wall](double t) {
                          const auto n = static_cast<std::size_t>(std::min(t, 3.5));
                          return wall.pressure[n] +
                                 (t - static_cast<double>(n)) * (wall.pressure[n + 1] - wall.pressure[n]);
                        }}};
    SolidModel model(setup);
    for (int n = 1; n <= 4; ++n) {
      advance(model, 0.5);
      advance(model, 0.5);
      const double found = 1 + 1e3 * model.accepted().motion.displacement.col(0).maxCoeff();
      // p/K = 2e-4 moves the inner wall by as much. At radius 2 the sphere is within 0.13 % of its largest pressure,
      // where the radius doubles all errors of the pressure by far: 1 % is 0.002 % of that.
      const bool is_near_limit = wall.symmetry.size() == 3 && n == 4;
      EXPECT_NEAR(found, radius[n], (is_near_limit ? 1e-2 : 1e-3) * radius[n]) << wall.name;
    }
    std::printf("thick %s: %ld iterations in 8 steps\n", wall.name, model.total_work().n_iterations);
    EXPECT_LE(model.total_work().n_iterations, 8 * 7) << wall.name;  // 32 and 48
    EXPECT_EQ(model.total_work().n_negative_pivots, 0);
  }
}

TEST(CantileverUnderEndMoment, RollsUpUnderFollowerPressuresWithFreeRims) {
  // A pair of follower pressures on the halves of the end face, M = q (h/2) b (h/2); 2 pi EI / L closes the circle. The
  // pressed halves end at free rims: the tangent is unsymmetric, without which the first tenth of the moment fails.
  SolidSetup setup = Cantilever::setup({16, 2, 2}, 8);
  setup.tractions.clear();
  for (const ElementFace& face : setup.mesh.find_surface("x_max", "test")) {
    double height = 0;
    const FaceNodes nodes = setup.mesh.nodes_of(face);
    for (const Index node : nodes) height += setup.mesh.node_position(node, 2) / static_cast<double>(nodes.size());
    setup.mesh.surface[height > 0.05 ? "upper" : "lower"].push_back(face);
  }
  const double whole_moment = 2 * std::numbers::pi * 1.2e6 * std::pow(0.1, 3) / 12 / 10, arm = 0.05;
  const double pressure = whole_moment / (arm * arm);
  setup.pressures = {{"upper", [=](double t) { return pressure * t; }},
                     {"lower", [=](double t) { return -pressure * t; }}};
  SolidModel model(setup);
  const auto tip = [&] {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int n_nodes = 0;
    for (const Index node : model.mesh().find_nodes("x_max", "test"))
      sum += model.accepted().motion.displacement.row(node).head<3>(), ++n_nodes;
    return Eigen::Vector3d(sum / n_nodes);
  };
  advance(model, 0.125);
  const Eigen::Vector3d eighth = tip();
  for (int n = 1; n < 8; ++n) advance(model, 0.125);
  const Eigen::Vector3d whole = tip();
  std::printf("end moment: an eighth %.4f %.4f, whole %.4f %.4f, %ld iterations\n", eighth.x(), eighth.z(), whole.x(),
              whole.z(), model.total_work().n_iterations);
  // The pair is not quite a moment: where it warps the end, its forces of 1250 N turn by unlike angles, and a
  // thousandth of that, ten metres away, is a third of the moment of a quarter circle. Second order in the moment: 0.3
  // % at an eighth.
  const double angle = std::numbers::pi / 4;
  EXPECT_NEAR(eighth.x(), 10 * (std::sin(angle) / angle - 1), 0.01 * 10);
  EXPECT_NEAR(std::abs(eighth.z()), 10 * (1 - std::cos(angle)) / angle, 0.01 * 10);
  EXPECT_LE((whole - Eigen::Vector3d(-10, 0, 0)).norm(), 0.1 * 10);
  EXPECT_LE(model.total_work().n_iterations, 90);  // 64
}

/// A shallow arch w = rise sin(pi x / L), pinned at the middle of both ends, under a vertical load q sin(pi x / L) per
/// length, as a strip of solid elements, E = 1 MPa, nu = 0, L = 1 m, h = 2.5 mm, as wide as high.
struct Arch {
  static constexpr double length = 1, height = 0.0025, width = 0.0025, young = 1e6;
  double rise, reference_load;  // lambda_1 = rise / (2 rho), rho^2 = I/A; q_0 = EI (pi/L)^4 2 rho
  SolidModel model;

  explicit Arch(double lambda_1)
      : rise(2 * lambda_1 * height / std::sqrt(12.0)),
        reference_load(young * width * std::pow(height, 3) / 12 * std::pow(std::numbers::pi / length, 4) * 2 * height /
                       std::sqrt(12.0)),
        model(setup(rise)) {}

  static SolidSetup setup(double rise) {
    SolidSetup setup = static_setup(SaintVenantKirchhoff::from_young(young, 0), 8);
    setup.mesh = make_box_mesh({{length, width, height}, {16, 1, 2}});
    const double end = length, middle = height / 2;
    for (Index n = 0; n < setup.mesh.n_nodes(); ++n) {
      auto X = setup.mesh.node_position.row(n);
      if (std::abs(X.z() - middle) < 1e-12 && (X.x() < 1e-12 || X.x() > end - 1e-12))
        setup.mesh.node_set["pins"].push_back(n);
      // Sections stay perpendicular to the arch.
      const double s = X.x(), slope = rise * std::numbers::pi / length * std::cos(std::numbers::pi * s / length);
      const double z = X.z() - middle, norm = std::sqrt(1 + slope * slope);
      X = Eigen::RowVector3d(s - z * slope / norm, X.y(), rise * std::sin(std::numbers::pi * s / length) + z / norm);
    }
    setup.supports.fixed = {"pins"};
    setup.supports.symmetry = {{"y_min", 1}, {"y_max", 1}};
    setup.wetted = {"z_max"};
    return setup;
  }

  /// Nodal forces of the unit load q_0 on the upper face.
  surface::NodeArray unit_load() const {
    std::map<Index, double> force;
    for (const ElementFace& face : model.mesh().find_surface("z_max", "test")) {
      const FaceNodes nodes = model.mesh().nodes_of(face);
      for (const FaceQuadraturePoint& point : face_quadrature(nodes.shape())) {
        const auto N = shape_values(nodes.shape(), point.xi);
        const auto gradient = shape_gradient(nodes.shape(), point.xi);
        double x = 0, dx[2] = {0, 0}, dy[2] = {0, 0};
        for (std::size_t a = 0; a < nodes.size(); ++a) {
          const auto row = static_cast<Eigen::Index>(a);
          x += N[row] * model.mesh().node_position(nodes[a], 0);
          for (int k = 0; k < 2; ++k) {
            dx[k] += gradient(row, k) * model.mesh().node_position(nodes[a], 0);
            dy[k] += gradient(row, k) * model.mesh().node_position(nodes[a], 1);
          }
        }
        const double area = std::abs(dx[0] * dy[1] - dx[1] * dy[0]) * point.weight;
        const double q = reference_load / width * std::sin(std::numbers::pi * x / length);
        for (std::size_t a = 0; a < nodes.size(); ++a) force[nodes[a]] -= N[static_cast<Eigen::Index>(a)] * q * area;
      }
    }
    const auto& wetted = model.wetted().solid_node;
    surface::NodeArray load = surface::NodeArray::Zero(static_cast<Eigen::Index>(wetted.size()), 3);
    for (std::size_t n = 0; n < wetted.size(); ++n) load(static_cast<Eigen::Index>(n), 2) = force[wetted[n]];
    return load;
  }
};

TEST(ShallowArch, SnapsThroughAtItsLimitLoad) {
  // Closed form of the sinusoidal shallow arch: q / q_0 = 2.0379 for lambda_1 = 1.5, 4 for 2, 11.7093 for 3, whose path
  // then leads through a load of -5.7093. Pins on a line of nodes
  // give way by some h, which a bar without section does not: -0.3 % here, -1.1 % at four times the thickness. The
  // parabola through three points of the path is good to as much.
  for (const auto& [lambda_1, limit] : {std::pair{1.5, 2.0379}, std::pair{2.0, 4.0}, std::pair{3.0, 11.7093}}) {
    Arch arch(lambda_1);
    const double load = 1.5 * limit;
    arch.model.solve_step(1, load * arch.unit_load());
    arch.model.accept_step();
    const StepWork& work = arch.model.work_of_last_step();
    ASSERT_GE(work.limit_loads.size(), 1u);
    std::printf("arch, lambda_1 = %.1f: limit %.4f q_0 (%.4f), %ld arcs, %ld iterations\n", lambda_1,
                work.limit_loads[0] * load, limit, work.n_substeps, work.n_iterations);
    // The first arcs are those of a sixteenth of the step, whose load for 3 is as large as a tenth of the limit.
    EXPECT_NEAR(work.limit_loads[0] * load, limit, (lambda_1 < 3 ? 0.006 : 0.02) * limit);
    EXPECT_EQ(work.n_negative_pivots, 0);
    EXPECT_LT(arch.model.accepted().motion.displacement.col(2).minCoeff(), -1.5 * arch.rise);  // it hangs now
  }
}

TEST(PrescribedDisplacement, StretchesABlockAsTheLawSays) {
  // Saint Venant-Kirchhoff, E = 15 kPa, nu = 0.475, stretch 1.2: nominal stress 3.96 kPa, lateral stretch 0.889382.
  SolidSetup setup = static_setup(SaintVenantKirchhoff::from_young(15e3, 0.475), 8);
  setup.mesh = make_box_mesh({{0.01, 0.01, 0.01}, {2, 2, 2}});
  setup.supports.symmetry = {{"x_min", 0}, {"y_min", 1}, {"z_min", 2}};
  setup.supports.prescribed = {{"x_max", 0, [](const Eigen::Vector3d&, double t) { return 0.002 * t; }}};
  SolidModel model(setup);
  for (int n = 0; n < 2; ++n) advance(model, 0.5);
  EXPECT_NEAR(model.accepted().motion.displacement.col(1).minCoeff(), 0.01 * (0.889382 - 1), 1e-8);  // six digits known
  const auto reactions = model.reactions();
  EXPECT_NEAR(reactions[0].force.x(), 3960 * 1e-4, 1e-6 * 0.396);
  EXPECT_NEAR(reactions[1].force.x(), -3960 * 1e-4, 1e-6 * 0.396);
  EXPECT_LE(model.total_work().n_iterations, 14);
}

TEST(StaticSteps, AreEqualBitsWhateverWasAskedBefore) {
  Cantilever plain({8, 2, 1}, 8), asked({8, 2, 1}, 8);
  const surface::NodeArray none = surface::NodeArray::Zero(0, 3);
  for (int n = 0; n < 3; ++n) {
    plain.model.solve_step(0.1, none);
    asked.model.solve_step(0.3, none);
    asked.model.solve_step(0.1, none);
    plain.model.accept_step(), asked.model.accept_step();
    EXPECT_TRUE(plain.model.accepted().motion.displacement == asked.model.accepted().motion.displacement);
  }
}

}  // namespace
}  // namespace couplet::solid
